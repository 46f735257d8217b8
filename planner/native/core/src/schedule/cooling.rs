//! How far a cycle of annealing has cooled.

use std::time::Instant;

/// How a cycle of annealing is divided.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cooling {
    /// By the lists tried.
    Lists(u64),
    /// By the clock, from when to when: how many lists that will be is a guess.
    Clock(Instant, Instant),
}

impl Cooling {
    /// From now on, to be over by then.
    pub fn until(deadline: Instant) -> Self {
        Self::Clock(Instant::now(), deadline)
    }

    /// What part of the cycle is over.
    pub fn progress(self, lists: u64) -> f64 {
        match self {
            Self::Lists(length) => lists as f64 / length as f64,
            Self::Clock(begun, end) => {
                let whole_s = end.saturating_duration_since(begun).as_secs_f64();
                begun.elapsed().as_secs_f64() / whole_s
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::Cooling;

    #[test]
    fn cycles_end_with_their_lists_or_with_their_time() {
        assert_eq!(Cooling::Lists(8).progress(2), 0.25);
        assert_eq!(Cooling::Lists(8).progress(8), 1.0);
        let soon = Cooling::until(Instant::now() + Duration::from_secs(3600));
        assert!(soon.progress(u64::MAX) < 0.1);
        let now = Instant::now();
        let over = Cooling::Clock(now - Duration::from_millis(20), now);
        assert!(over.progress(0) >= 1.0);
    }
}
