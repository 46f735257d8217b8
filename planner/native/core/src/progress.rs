//! Live counters of a run, for whoever waits for it in another thread.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a run has done; the fields are those of the report that it will end with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// States whose successors were generated.
    pub expansions: u64,
    /// Heuristic evaluations.
    pub evaluations: u64,
    /// Plans built by the list-schedule search.
    pub schedules: u64,
    /// Ground operators.
    pub operators: usize,
    /// Ground facts that states store.
    pub facts: usize,
    /// No plan is better than this; 0 if nothing is known.
    pub lower_bound: f64,
    /// Time for grounding [s].
    pub grounding_s: f64,
}

/// What a run has done so far.
#[derive(Debug, Default)]
pub struct Progress {
    parts: Mutex<Parts>,
}

/// What was done in narrower parts of the problem, and in the one at hand.
#[derive(Debug, Default)]
struct Parts {
    before: Counts,
    now: Counts,
}

impl Progress {
    /// Tells what has been done in the part at hand.
    pub fn tell(&self, now: Counts) {
        self.parts().now = now;
    }

    /// From now on it is told of a wider part.
    pub fn widen(&self) {
        let mut parts = self.parts();
        parts.before = parts.sum();
        parts.now = Counts::default();
    }

    /// What has been done so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.parts().sum()
    }

    fn parts(&self) -> MutexGuard<'_, Parts> {
        self.parts.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Parts {
    fn sum(&self) -> Counts {
        let Self { before, now } = self;
        // Before a wider part is grounded, the narrower one's size is the last known.
        let size = if now.operators > 0 { now } else { before };
        Counts {
            expansions: before.expansions + now.expansions,
            evaluations: before.evaluations + now.evaluations,
            schedules: before.schedules + now.schedules,
            operators: size.operators,
            facts: size.facts,
            lower_bound: now.lower_bound,
            grounding_s: before.grounding_s + now.grounding_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Counts, Progress};

    #[test]
    fn what_is_told_can_be_read_and_wider_parts_are_added() {
        let progress = Progress::default();
        assert_eq!(progress.counts(), Counts::default());
        let narrow = Counts {
            expansions: 7,
            schedules: 2,
            operators: 30,
            ..Counts::default()
        };
        progress.tell(narrow);
        assert_eq!(progress.counts(), narrow);
        progress.widen();
        assert_eq!(progress.counts(), narrow);
        progress.tell(Counts {
            expansions: 1,
            operators: 90,
            lower_bound: 2.5,
            ..Counts::default()
        });
        let counts = progress.counts();
        assert_eq!((counts.expansions, counts.schedules), (8, 2));
        assert_eq!((counts.operators, counts.lower_bound), (90, 2.5));
    }
}
