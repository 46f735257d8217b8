//! When a search that was to end is no longer waited for.
//!
//! A search looks at its limits some thousand times a second, but not inside single passes over very
//! large tables, or while it gives them back. Whoever waits for it gets what is known by then.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use planner_core::outcome::Limit;

/// How long a search has to tell its end by itself.
const GRACE: Duration = Duration::from_millis(10);

/// When a search is to end.
pub struct Overdue {
    deadline: Option<Instant>,
    cancelled: Mutex<Option<Instant>>,
}

impl Overdue {
    /// For a search with a time limit from now on, if any.
    pub fn after(timeout: Option<Duration>) -> Self {
        Self {
            deadline: timeout.and_then(|timeout| Instant::now().checked_add(timeout)),
            cancelled: Mutex::new(None),
        }
    }

    /// Remembers when it was asked to stop first.
    pub fn cancel(&self) {
        let mut cancelled = self
            .cancelled
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        cancelled.get_or_insert_with(Instant::now);
    }

    /// How long to go on waiting for it, and what ends it then; `None` if nothing does.
    pub fn left(&self) -> Option<(Duration, Limit)> {
        let cancelled = *self
            .cancelled
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let cancelled = cancelled.map(|at| (at, Limit::Cancelled));
        let timed_out = self.deadline.map(|at| (at, Limit::Time));
        let ends = cancelled.into_iter().chain(timed_out);
        let (at, limit) = ends.min_by_key(|end| end.0)?;
        let left = (at + GRACE).saturating_duration_since(Instant::now());
        Some((left, limit))
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use planner_core::outcome::Limit;

    use super::{GRACE, Overdue};

    #[test]
    fn the_first_of_deadline_and_request_ends_the_wait() {
        assert_eq!(Overdue::after(None).left(), None);
        let hour = Duration::from_secs(3_600);
        let overdue = Overdue::after(Some(hour));
        let (left, limit) = overdue.left().expect("a deadline");
        assert!(left > hour / 2 && limit == Limit::Time);
        overdue.cancel();
        let (left, limit) = overdue.left().expect("a request");
        assert!(left <= GRACE && limit == Limit::Cancelled);
        let (left, limit) = Overdue::after(Some(Duration::ZERO))
            .left()
            .expect("a deadline");
        assert!(left <= GRACE && limit == Limit::Time);
    }
}
