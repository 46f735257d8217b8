//! The FF heuristic on the temporal delete relaxation, supporters chosen by h_add.
//!
//! Source: Hoffmann and Nebel, "The FF planning system", JAIR 14, 2001; supporters as in Keyder and
//! Geffner, "Heuristics for planning with action costs revisited", ECAI 2008. Not admissible; safe:
//! a dead end is one of the delete relaxation. Durations count where a window would close too
//! early (see [`super::relaxed`]).

use crate::epoch::compiled::Compiled;
use crate::epoch::state::State;
use crate::task::OperatorId;

use super::additive::{AGENDA, AdditiveExploration, NOBODY};
use super::relaxed::{Proposition, RelaxedTask};
use super::repetition::repetitions;
use super::{Estimate, Heuristic};

/// FF with preferred operators.
pub struct TemporalFf<'a> {
    compiled: &'a Compiled<'a>,
    relaxed: &'a RelaxedTask,
    exploration: AdditiveExploration<'a>,
    in_plan: Vec<u32>,
    stamp: u32,
    stack: Vec<Proposition>,
    seen: Vec<u32>,
    preferred: Vec<OperatorId>,
    waiting: bool,
}

impl<'a> TemporalFf<'a> {
    /// For one task.
    #[must_use]
    pub fn new(compiled: &'a Compiled<'a>, relaxed: &'a RelaxedTask) -> Self {
        Self {
            compiled,
            relaxed,
            exploration: AdditiveExploration::new(compiled, relaxed),
            in_plan: vec![0; compiled.operators.len()],
            stamp: 0,
            stack: Vec::new(),
            seen: vec![0; relaxed.propositions as usize],
            preferred: Vec::new(),
            waiting: false,
        }
    }

    /// The additive costs under it.
    pub(super) fn exploration(&self) -> &AdditiveExploration<'a> {
        &self.exploration
    }

    /// Tells the additive costs what holds in a state.
    pub(super) fn seed(&mut self, state: &State) {
        self.exploration.seed(state);
    }

    /// Walks back from the goal and returns the number of actions used.
    fn extract(&mut self, state: &State) -> u32 {
        self.stamp += 1;
        self.preferred.clear();
        self.waiting = false;
        let relaxed = self.relaxed;
        let mut total = 0_u32;
        self.stack.clear();
        self.stack.extend_from_slice(&relaxed.goal);
        while let Some(proposition) = self.stack.pop() {
            let slot = proposition as usize;
            if self.seen[slot] == self.stamp {
                continue;
            }
            self.seen[slot] = self.stamp;
            let index = self.exploration.supporter(proposition);
            if index == AGENDA {
                self.waiting = true;
                continue;
            }
            if index == NOBODY {
                continue;
            }
            let action = &relaxed.actions[index as usize];
            self.stack
                .extend_from_slice(relaxed.preconditions_of(index));
            if action.is_axiom() {
                continue;
            }
            let slot = action.operator.index();
            let mut times = 1;
            if proposition >= relaxed.first_comparison {
                let comparison = proposition - relaxed.first_comparison;
                let supports = relaxed.supports_of(index).map(|(_, support)| support);
                times = supports
                    .filter(|support| support.comparison == comparison)
                    .filter_map(|support| repetitions(relaxed, support, state))
                    .min()
                    .unwrap_or(1);
            }
            if self.in_plan[slot] == self.stamp {
                total = total.saturating_add(times - 1);
                continue;
            }
            self.in_plan[slot] = self.stamp;
            total = total.saturating_add(times);
            let operator = self.compiled.operator(action.operator);
            if operator.start_condition.literals_hold(&state.facts) {
                self.preferred.push(action.operator);
            }
        }
        total
    }
}

impl Heuristic for TemporalFf<'_> {
    fn evaluate(&mut self, state: &State) -> Estimate {
        self.exploration.seed(state);
        if !self.exploration.explore(state) {
            return Estimate::DeadEnd;
        }
        Estimate::Value(self.extract(state))
    }

    fn preferred(&self) -> &[OperatorId] {
        &self.preferred
    }

    fn prefers_waiting(&self) -> bool {
        self.waiting || self.preferred.is_empty()
    }
}
