//! How long a cycle of local search is, and how far it has come.

use std::time::Instant;

/// The length of a cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cycle {
    /// Lists that are tried in it; a guess if it is divided by the clock.
    pub lists: u64,
    /// From when to when it lasts, if it does not end with its lists.
    clock: Option<(Instant, Instant)>,
}

impl Cycle {
    /// Divided by the lists tried.
    pub fn of(lists: u64) -> Self {
        Self { lists, clock: None }
    }

    /// Divided by the clock: from now on, to be over by then, probably after so many lists.
    pub fn until(deadline: Instant, lists: u64) -> Self {
        Self {
            lists,
            clock: Some((Instant::now(), deadline)),
        }
    }

    /// What part of the cycle is over after so many lists.
    pub fn progress(self, lists: u64) -> f64 {
        match self.clock {
            None => lists as f64 / self.lists as f64,
            Some((begun, end)) => {
                let whole_s = end.saturating_duration_since(begun).as_secs_f64();
                begun.elapsed().as_secs_f64() / whole_s
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::Cycle;

    #[test]
    fn cycles_end_with_their_lists_or_with_their_time() {
        assert_eq!(Cycle::of(8).progress(2), 0.25);
        assert_eq!(Cycle::of(8).progress(8), 1.0);
        let soon = Cycle::until(Instant::now() + Duration::from_secs(3600), 8);
        assert!(soon.progress(u64::MAX) < 0.1);
        let over = Cycle::until(Instant::now() - Duration::from_millis(20), 8);
        assert!(over.progress(0) >= 1.0);
    }
}
