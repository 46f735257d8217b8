//! The blind heuristic: 0 at goals, 1 elsewhere; for measuring and as an oracle in tests.

use crate::epoch::compiled::Compiled;
use crate::epoch::state::State;
use crate::task::OperatorId;

use super::{Estimate, Heuristic};

/// Knows only whether the goal's literals hold.
pub struct Blind<'a> {
    compiled: &'a Compiled<'a>,
}

impl<'a> Blind<'a> {
    /// For one task.
    #[must_use]
    pub fn new(compiled: &'a Compiled<'a>) -> Self {
        Self { compiled }
    }
}

impl Heuristic for Blind<'_> {
    fn evaluate(&mut self, state: &State) -> Estimate {
        Estimate::Value(u32::from(!self.compiled.goal.literals_hold(&state.facts)))
    }

    fn preferred(&self) -> &[OperatorId] {
        &[]
    }

    fn prefers_waiting(&self) -> bool {
        false
    }
}
