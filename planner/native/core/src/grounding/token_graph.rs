//! Where a fact that can be used up once goes: what was added in its place, and in place of that.

use rustc_hash::FxHashSet;

use crate::task::FactId;

use super::dead_end_operators::Uses;

/// Facts of one token, at most.
pub(super) const LARGEST_GRAPH: usize = 256;

/// Where one token goes.
pub(super) struct TokenGraph {
    /// Facts that may hold it, in an order in which it passes them.
    facts: Vec<FactId>,
    member: FxHashSet<FactId>,
    /// Operators that move it.
    steps: Vec<u32>,
}

impl TokenGraph {
    /// The graph of a fact that holds at first and that nothing adds.
    pub(super) fn new(uses: &Uses, token: FactId) -> Self {
        let mut graph = Self {
            facts: vec![token],
            member: std::iter::once(token).collect(),
            steps: Vec::new(),
        };
        let mut is_step = FxHashSet::default();
        // Operators that give the token to a fact already.
        let mut gives = FxHashSet::default();
        let mut next = 0;
        while next < graph.facts.len() && graph.facts.len() < LARGEST_GRAPH {
            let fact = graph.facts[next];
            next += 1;
            let mut candidates = Vec::new();
            for &step in &uses.takers[fact.index()] {
                if is_step.insert(step) {
                    graph.steps.push(step);
                }
                candidates.extend_from_slice(&uses.added[step as usize]);
            }
            candidates.sort_unstable();
            candidates.dedup();
            for candidate in candidates {
                let index = candidate.index();
                let adders = &uses.adders[index];
                // Without a taker it leads nowhere.
                if !uses.takers[index].is_empty()
                    && !uses.initial[index]
                    && !uses.given[index]
                    && !graph.member.contains(&candidate)
                    && adders
                        .iter()
                        .all(|adder| is_step.contains(adder) && !gives.contains(adder))
                {
                    gives.extend(adders.iter().copied());
                    graph.member.insert(candidate);
                    graph.facts.push(candidate);
                }
            }
        }
        graph
    }

    /// Rules out the steps that no path joins with an achiever of a goal, where all achievers are steps.
    pub(super) fn rule_out(&self, uses: &Uses, goals: &[FactId], kept: &mut [bool]) {
        let steps: FxHashSet<u32> = self.steps.iter().copied().collect();
        for goal in goals {
            let achievers = &uses.adders[goal.index()];
            if achievers.is_empty() || !achievers.iter().all(|adder| steps.contains(adder)) {
                continue;
            }
            let mut joined: FxHashSet<u32> = achievers.iter().copied().collect();
            // Facts that the token passes before and after an achiever.
            let (mut before, mut after) = (FxHashSet::default(), FxHashSet::default());
            for &step in achievers {
                before.extend(self.taken(uses, step));
                after.extend(self.given(uses, step));
            }
            let mut stack: Vec<FactId> = before.iter().copied().collect();
            while let Some(fact) = stack.pop() {
                for &step in &uses.adders[fact.index()] {
                    joined.insert(step);
                    let origins = self
                        .taken(uses, step)
                        .filter(|origin| before.insert(*origin));
                    stack.extend(origins.collect::<Vec<_>>());
                }
            }
            let mut stack: Vec<FactId> = after.iter().copied().collect();
            while let Some(fact) = stack.pop() {
                for &step in &uses.takers[fact.index()] {
                    joined.insert(step);
                    let places = self.given(uses, step).filter(|place| after.insert(*place));
                    stack.extend(places.collect::<Vec<_>>());
                }
            }
            for step in &self.steps {
                kept[*step as usize] &= joined.contains(step);
            }
        }
    }

    fn taken<'a>(&'a self, uses: &'a Uses, step: u32) -> impl Iterator<Item = FactId> + 'a {
        let taken = uses.taken[step as usize].iter().copied();
        taken.filter(|fact| self.member.contains(fact))
    }

    fn given<'a>(&'a self, uses: &'a Uses, step: u32) -> impl Iterator<Item = FactId> + 'a {
        let added = uses.added[step as usize].iter().copied();
        added.filter(|fact| self.member.contains(fact))
    }
}
