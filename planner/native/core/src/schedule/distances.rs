//! Shortest chains of rules to a target: lower bounds that guide relaxed exploration.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

use crate::schedule::model::NONE;
use crate::schedule::propositions::{Propositions, Rule};

/// Largest number of distances kept.
const DISTANCE_MEMORY: usize = 8_000_000;

/// Needs looked at when distances are computed; farther propositions count as being as far as the
/// last one reached.
const DISTANCE_EFFORT: usize = 100_000;

/// A rule and the least time from its start to the target [s].
pub type Ahead = (f32, u32);

/// Lower bounds on the time from a proposition, or from the start of a rule, to a target [s].
#[derive(Clone, Debug)]
pub struct Distances {
    pub propositions: Vec<f32>,
    /// Where the rules that watch a proposition begin and end; [`NONE`] until they are asked for.
    rows: Vec<(u32, u32)>,
    entries: Vec<Ahead>,
}

impl Distances {
    /// The rules that watch a proposition and lead to the target, the nearest to it first, as a
    /// range for [`Self::entry`].
    pub fn watching(
        &mut self,
        propositions: &Propositions,
        proposition: u32,
    ) -> std::ops::Range<usize> {
        let index = proposition as usize;
        if self.rows[index].0 == NONE {
            let from = self.entries.len();
            for rule in propositions.watching.row(proposition) {
                let ahead = self.of_rule(propositions, *rule);
                if ahead.is_finite() {
                    self.entries.push((ahead, *rule));
                }
            }
            self.entries[from..].sort_unstable_by(|left, right| {
                left.0.total_cmp(&right.0).then(left.1.cmp(&right.1))
            });
            self.rows[index] = (from as u32, self.entries.len() as u32);
        }
        let (from, to) = self.rows[index];
        from as usize..to as usize
    }

    /// A rule of a range.
    pub fn entry(&self, index: usize) -> Ahead {
        self.entries[index]
    }

    /// From the start of a rule [s].
    pub fn of_rule(&self, propositions: &Propositions, rule: u32) -> f32 {
        let rule = &propositions.rules[rule as usize];
        through(propositions, rule, &self.propositions)
    }

    fn size(&self) -> usize {
        3 * self.propositions.len() + 2 * self.entries.len()
    }
}

/// The distance of a rule by the distances of what it adds.
fn through(propositions: &Propositions, rule: &Rule, distance: &[f32]) -> f32 {
    let late = propositions.needs(rule).iter().any(|need| need.at_end);
    let adds = propositions.adds(rule).iter().map(|add| {
        let lasts = if add.at_end && !late {
            rule.duration
        } else {
            0.0
        };
        lasts + distance[add.proposition as usize]
    });
    adds.fold(f32::INFINITY, f32::min)
}

/// A queue entry: propositions in the order of their priorities.
pub fn key(priority: f32, proposition: u32) -> Reverse<u64> {
    // Non-negative floats are ordered like their bits.
    Reverse(u64::from(priority.max(0.0).to_bits()) << 32 | u64::from(proposition))
}

/// Distances by target, as many as memory allows.
#[derive(Clone, Debug, Default)]
pub struct DistanceCache {
    by_target: FxHashMap<u32, Distances>,
    kept: usize,
    queue: BinaryHeap<Reverse<u64>>,
}

impl DistanceCache {
    /// The distances to a target, out of the cache until they are given back.
    pub fn take(&mut self, propositions: &Propositions, target: u32) -> Distances {
        match self.by_target.remove(&target) {
            Some(known) => {
                self.kept -= known.size();
                known
            }
            None => self.compute(propositions, target),
        }
    }

    /// Keeps distances for the next time.
    pub fn give_back(&mut self, target: u32, distances: Distances) {
        self.kept += distances.size();
        self.by_target.insert(target, distances);
    }

    /// Shortest chains of rules to a target [s], computed by Dijkstra backwards.
    fn compute(&mut self, propositions: &Propositions, target: u32) -> Distances {
        let count = propositions.count();
        if self.kept + 3 * count > DISTANCE_MEMORY {
            self.by_target.clear();
            self.kept = 0;
        }
        let mut distance = vec![f32::INFINITY; count];
        distance[target as usize] = 0.0;
        self.queue.clear();
        self.queue.push(key(0.0, target));
        let mut effort = 0;
        while let Some(Reverse(entry)) = self.queue.pop() {
            let proposition = entry as u32;
            let reached = f32::from_bits((entry >> 32) as u32);
            if reached > distance[proposition as usize] {
                continue;
            }
            if effort > DISTANCE_EFFORT {
                for far in &mut distance {
                    *far = far.min(reached);
                }
                break;
            }
            for rule in propositions.adding.row(proposition) {
                let rule = &propositions.rules[*rule as usize];
                let at_end = propositions
                    .adds(rule)
                    .iter()
                    .any(|add| add.proposition == proposition && add.at_end);
                let through = reached + if at_end { rule.duration } else { 0.0 };
                effort += propositions.needs(rule).len();
                for need in propositions.needs(rule) {
                    let through = if need.at_end { reached } else { through };
                    if through < distance[need.proposition as usize] {
                        distance[need.proposition as usize] = through;
                        self.queue.push(key(through, need.proposition));
                    }
                }
            }
        }
        Distances {
            propositions: distance,
            rows: vec![(NONE, NONE); count],
            entries: Vec::new(),
        }
    }
}
