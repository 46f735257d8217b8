//! Entries of the open lists of best-first searches.

use std::cmp::Ordering;

/// What is to be expanded, in a `BinaryHeap`: the smallest key first, then the smallest id.
#[derive(PartialEq)]
pub(crate) struct Open {
    /// Cost so far plus an estimate of the rest.
    pub key: f64,
    /// A node or a state.
    pub id: usize,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.key.total_cmp(&self.key).then(other.id.cmp(&self.id))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
