//! When CPU time will be used up: turns are planned on the wall clock.

use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};

use crate::solve::SolveOptions;

/// CPU time that tells more about the pace than the number of threads does.
const TELLING: Duration = Duration::from_millis(20);

/// The pace of this process, measured from when it was made.
#[derive(Clone, Copy, Debug)]
pub(super) struct CpuClock {
    begun: Instant,
    spent: Duration,
}

impl CpuClock {
    pub fn start() -> Self {
        Self {
            begun: Instant::now(),
            spent: cpu_time(),
        }
    }

    /// When the CPU time that the options grant is used up if the process goes on at its pace.
    pub fn used_up(&self, options: &SolveOptions<'_>) -> Option<Instant> {
        let now = cpu_time();
        let left = options.cpu_deadline?.saturating_sub(now);
        let spent = now.saturating_sub(self.spent);
        let wall_for_cpu = if spent < TELLING {
            1.0 / options.threads.max(1) as f64
        } else {
            self.begun.elapsed().as_secs_f64() / spent.as_secs_f64()
        };
        Instant::now().checked_add(left.mul_f64(wall_for_cpu))
    }
}

/// CPU time that the process has used since its start.
fn cpu_time() -> Duration {
    Duration::try_from(clock_gettime(ClockId::ProcessCPUTime)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use std::hint::black_box;
    use std::time::{Duration, Instant};

    use super::{CpuClock, TELLING, cpu_time};
    use crate::solve::SolveOptions;

    fn granting(cpu: Duration, threads: usize) -> SolveOptions<'static> {
        SolveOptions {
            cpu_deadline: Some(cpu_time() + cpu),
            threads,
            ..SolveOptions::default()
        }
    }

    fn work_until(spent: Duration) {
        while cpu_time() < spent {
            black_box((0..10_000).sum::<u64>());
        }
    }

    #[test]
    fn threads_share_the_cpu_time_until_the_pace_is_known() {
        let clock = CpuClock {
            begun: Instant::now(),
            spent: cpu_time() + Duration::from_secs(3600),
        };
        for threads in [1, 2] {
            let end = clock.used_up(&granting(Duration::from_secs(100), threads));
            let left = end.map(|end| end.saturating_duration_since(Instant::now()));
            let expected = 100.0 / threads as f64;
            assert!(left.is_some_and(|left| (left.as_secs_f64() - expected).abs() < 1.0));
        }
    }

    #[test]
    fn a_process_that_gets_half_a_core_has_twice_the_time() {
        work_until(10 * TELLING);
        let (now, spent) = (Instant::now(), cpu_time());
        let clock = CpuClock {
            begun: now.checked_sub(2 * spent).unwrap_or(now),
            spent: Duration::ZERO,
        };
        let end = clock.used_up(&granting(Duration::from_secs(100), 1));
        let left = end.map(|end| end.saturating_duration_since(now).as_secs_f64());
        assert!(left.is_some_and(|left| (left - 200.0).abs() < 40.0));
    }

    #[test]
    fn nothing_is_left_once_it_is_spent_and_nothing_is_known_without_a_limit() {
        let clock = CpuClock::start();
        work_until(clock.spent + TELLING);
        let over = clock.used_up(&granting(Duration::ZERO, 1));
        assert!(over.is_some_and(|end| end <= Instant::now()));
        assert_eq!(clock.used_up(&SolveOptions::default()), None);
    }
}
