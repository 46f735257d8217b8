//! Shortest chains of rules to a target: lower bounds that guide relaxed exploration.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

use crate::schedule::propositions::{Propositions, Rule};

/// Largest number of distances kept.
const DISTANCE_MEMORY: usize = 8_000_000;

/// Needs looked at when distances are computed; farther propositions count as being as far as the
/// last one reached.
const DISTANCE_EFFORT: usize = 100_000;

/// Above this many rules their distances are computed when they are asked for.
const MANY_RULES: usize = 20_000;

/// Lower bounds on the time from a proposition, or from the start of a rule, to a target [s].
#[derive(Clone, Debug)]
pub struct Distances {
    pub propositions: Vec<f32>,
    /// Empty if there are too many.
    rules: Vec<f32>,
}

impl Distances {
    /// From the start of a rule [s].
    pub fn of_rule(&self, propositions: &Propositions, rule: u32) -> f32 {
        match self.rules.get(rule as usize) {
            Some(known) => *known,
            None => through(
                propositions,
                &propositions.rules[rule as usize],
                &self.propositions,
            ),
        }
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
            Some(known) => known,
            None => self.compute(propositions, target),
        }
    }

    /// Keeps distances for the next time.
    pub fn give_back(&mut self, target: u32, distances: Distances) {
        self.by_target.insert(target, distances);
    }

    /// Shortest chains of rules to a target [s], computed by Dijkstra backwards.
    fn compute(&mut self, propositions: &Propositions, target: u32) -> Distances {
        let count = propositions.count();
        let kept = if propositions.rules.len() > MANY_RULES {
            0
        } else {
            propositions.rules.len()
        };
        let size = count + kept;
        if self.kept + size > DISTANCE_MEMORY {
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
        let rules = if propositions.rules.len() > MANY_RULES {
            Vec::new()
        } else {
            let rules = propositions.rules.iter();
            rules
                .map(|rule| through(propositions, rule, &distance))
                .collect()
        };
        self.kept += size;
        Distances {
            propositions: distance,
            rules,
        }
    }
}
