//! Live counters of a run, for whoever waits for it in another thread.

use std::sync::atomic::{AtomicU64, Ordering};

/// What a run has done so far.
#[derive(Debug, Default)]
pub struct Progress {
    states: AtomicU64,
    lower_bound_bits: AtomicU64,
}

impl Progress {
    /// Tells states expanded and plans built so far, and the lower bound.
    pub fn tell(&self, states: u64, lower_bound: f64) {
        self.states.store(states, Ordering::Relaxed);
        self.lower_bound_bits
            .store(lower_bound.to_bits(), Ordering::Relaxed);
    }

    /// States expanded and plans built so far.
    #[must_use]
    pub fn states(&self) -> u64 {
        self.states.load(Ordering::Relaxed)
    }

    /// The lower bound so far; 0 if nothing is known.
    #[must_use]
    pub fn lower_bound(&self) -> f64 {
        f64::from_bits(self.lower_bound_bits.load(Ordering::Relaxed))
    }
}

#[cfg(test)]
mod tests {
    use super::Progress;

    #[test]
    fn what_is_told_can_be_read() {
        let progress = Progress::default();
        assert_eq!((progress.states(), progress.lower_bound()), (0, 0.0));
        progress.tell(7, 2.5);
        assert_eq!((progress.states(), progress.lower_bound()), (7, 2.5));
    }
}
