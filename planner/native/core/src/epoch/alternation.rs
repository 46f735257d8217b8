//! Open lists of several heuristics that take turns.
//!
//! Each heuristic has one list of all successors and one of those that some heuristic prefers. The
//! list that was served least is served next; progress of any heuristic serves the preferred ones
//! more often for a while.
//!
//! Source: Richter and Helmert, "Preferred operators and deferred evaluation in satisficing
//! planning", ICAPS 2009; Röger and Helmert, "The more, the merrier: combining heuristic estimators
//! for satisficing planning", ICAPS 2010 (alternation).

use super::open_list::{Entry, OpenList};
use super::registry::{Edge, NodeId};

/// Expansions that progress is worth to the lists of preferred successors.
const BOOST: i64 = 1_000;

#[derive(Debug)]
struct Pair {
    preferred: OpenList,
    all: OpenList,
    best: u32,
}

/// The open lists of one search.
#[derive(Debug)]
pub struct Alternation {
    pairs: Vec<Pair>,
}

impl Alternation {
    /// Empty lists for a number of heuristics.
    #[must_use]
    pub fn new(heuristics: usize) -> Self {
        let pair = || Pair {
            preferred: OpenList::default(),
            all: OpenList::default(),
            best: u32::MAX,
        };
        Self {
            pairs: (0..heuristics).map(|_| pair()).collect(),
        }
    }

    /// Tells what the heuristics say about the state that is expanded.
    pub fn note(&mut self, estimates: &[u32]) {
        let mut progress = false;
        for (pair, &estimate) in self.pairs.iter_mut().zip(estimates) {
            if estimate < pair.best {
                progress |= pair.best != u32::MAX;
                pair.best = estimate;
            }
        }
        if progress {
            for pair in &mut self.pairs {
                pair.preferred.priority -= BOOST;
            }
        }
    }

    /// Adds a node's successors under a priority a heuristic.
    pub fn push(
        &mut self,
        node: NodeId,
        priorities: &[u32],
        mut edges: Vec<Edge>,
        mut preferred: Vec<Edge>,
    ) {
        let last = self.pairs.len() - 1;
        for (index, (pair, &priority)) in self.pairs.iter_mut().zip(priorities).enumerate() {
            let own = |edges: &mut Vec<Edge>| {
                if index == last {
                    std::mem::take(edges)
                } else {
                    edges.clone()
                }
            };
            for (list, edges) in [
                (&mut pair.all, &mut edges),
                (&mut pair.preferred, &mut preferred),
            ] {
                let edges = own(edges);
                list.push(priority, Entry { node, edges });
            }
        }
    }

    /// Takes the next successor to try; entries that `stale` names are dropped.
    pub fn pop(&mut self, stale: &mut dyn FnMut(NodeId) -> bool) -> Option<(NodeId, Edge)> {
        loop {
            let lists = self
                .pairs
                .iter_mut()
                .flat_map(|pair| [&mut pair.preferred, &mut pair.all]);
            let list = lists
                .filter(|list| !list.is_empty())
                .min_by_key(|list| list.priority)?;
            list.priority += 1;
            if let Some(next) = list.pop(stale) {
                return Some(next);
            }
        }
    }

    /// Bytes held, about.
    #[must_use]
    pub fn memory(&self) -> usize {
        let lists = self.pairs.iter().flat_map(|p| [&p.preferred, &p.all]);
        lists.map(OpenList::memory).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::OperatorId;

    fn edge(number: u32) -> Edge {
        Edge::start(OperatorId(number), false)
    }

    fn order(lists: &mut Alternation) -> Vec<u32> {
        std::iter::from_fn(|| lists.pop(&mut |_| false))
            .filter_map(|(_, edge)| edge.operator())
            .map(|(operator, _)| operator.0)
            .collect()
    }

    #[test]
    fn heuristics_take_turns_each_in_its_own_order() {
        let mut lists = Alternation::new(2);
        lists.push(NodeId(0), &[1, 9], vec![edge(0)], Vec::new());
        lists.push(NodeId(1), &[2, 8], vec![edge(1)], Vec::new());
        assert_eq!(order(&mut lists), [0, 1, 1, 0]);
    }

    #[test]
    fn progress_serves_preferred_successors_first() {
        let mut lists = Alternation::new(1);
        lists.note(&[5]);
        lists.push(
            NodeId(0),
            &[1],
            vec![edge(0), edge(1)],
            vec![edge(2), edge(3)],
        );
        assert_eq!(order(&mut lists), [3, 1, 2, 0]);
        lists.push(
            NodeId(0),
            &[1],
            vec![edge(0), edge(1)],
            vec![edge(2), edge(3)],
        );
        lists.note(&[4]);
        assert_eq!(order(&mut lists), [3, 2, 1, 0]);
    }

    #[test]
    fn stale_nodes_are_dropped_from_every_list() {
        let mut lists = Alternation::new(2);
        lists.push(NodeId(0), &[1, 1], vec![edge(0)], vec![edge(0)]);
        lists.push(NodeId(1), &[2, 2], vec![edge(1)], Vec::new());
        let mut left = Vec::new();
        while let Some((node, _)) = lists.pop(&mut |node| node == NodeId(0)) {
            left.push(node.0);
        }
        assert_eq!(left, [1, 1]);
    }
}
