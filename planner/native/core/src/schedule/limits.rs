//! When the search of list schedules stops.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// What bounds a run.
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// When to stop.
    pub deadline: Option<Instant>,
    /// Until when the first two lists of all may be finished, if that is later: ones that are cut
    /// off in every turn lead nowhere.
    pub patience: Option<Instant>,
    /// Set by somebody else to stop.
    pub cancel: &'a AtomicBool,
    /// Largest number of lists to try.
    pub nodes: Option<u64>,
}

impl Limits<'_> {
    /// Whether it is time to stop.
    pub(super) fn reached(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
            || self
                .deadline
                .is_some_and(|deadline| Instant::now() >= deadline)
    }
}
