//! Expanded nodes with the successors still to try, in buckets of one priority each.
//!
//! With deferred evaluation all successors of a node share its heuristic value, so that one entry
//! holds them all and pushing costs one operation a node.

use std::collections::VecDeque;

use super::registry::{Edge, NodeId};

/// A node and its untried successors, taken from the back.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The node.
    pub node: NodeId,
    /// What to try.
    pub edges: Vec<Edge>,
}

/// A bucket queue, first in first out within a bucket.
#[derive(Clone, Debug, Default)]
pub struct OpenList {
    buckets: Vec<VecDeque<Entry>>,
    lowest: usize,
    entries: usize,
    edges: usize,
    /// Lower values are served first; raised by progress.
    pub priority: i64,
}

/// Priorities beyond this share the last bucket.
const BUCKETS: usize = 1 << 16;

impl OpenList {
    /// Adds a node.
    pub fn push(&mut self, priority: u32, entry: Entry) {
        if entry.edges.is_empty() {
            return;
        }
        let bucket = (priority as usize).min(BUCKETS - 1);
        if bucket >= self.buckets.len() {
            self.buckets.resize_with(bucket + 1, VecDeque::new);
        }
        self.lowest = if self.entries == 0 {
            bucket
        } else {
            self.lowest.min(bucket)
        };
        self.entries += 1;
        self.edges += entry.edges.len();
        self.buckets[bucket].push_back(entry);
    }

    /// Takes the next successor; entries that `stale` names are dropped.
    pub fn pop(&mut self, stale: &mut dyn FnMut(NodeId) -> bool) -> Option<(NodeId, Edge)> {
        while self.entries > 0 {
            let Some(entry) = self.buckets[self.lowest].front_mut() else {
                self.lowest += 1;
                continue;
            };
            let node = entry.node;
            if stale(node) {
                self.edges -= entry.edges.len();
                entry.edges.clear();
            }
            let edge = entry.edges.pop();
            self.edges -= usize::from(edge.is_some());
            if entry.edges.is_empty() {
                self.buckets[self.lowest].pop_front();
                self.entries -= 1;
            }
            if let Some(edge) = edge {
                return Some((node, edge));
            }
        }
        None
    }

    /// Whether nothing is left to try.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries == 0
    }

    /// Bytes held, about.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.edges * size_of::<Edge>() + self.entries * (size_of::<Entry>() + 16)
    }
}
