//! Heuristics of the decision-epoch search, one file each.
//!
//! All but the blind one and the critical path say how many actions are left. Extending: a file
//! with an implementation of [`Heuristic`], and a name in [`choice`].
//!
//! | heuristic | admissible | preferred operators | numbers |
//! |---|---|---|---|
//! | [`temporal_ff`] (FF over h_add) | no | yes | by repetition |
//! | [`context_enhanced_additive`] | no | yes | by repetition |
//! | [`critical_path`] (h_max over time) | for the makespan | no | ignored |
//! | [`blind`] | yes | no | ignored |

pub mod additive;
pub mod blind;
pub mod causal_graph;
pub mod choice;
pub mod context_enhanced_additive;
pub mod critical_path;
pub mod domain_transition_graph;
pub mod finite_domain;
pub mod relaxed;
mod repetition;
pub mod temporal_ff;
#[cfg(test)]
mod testing;

use crate::epoch::state::State;
use crate::task::OperatorId;

/// What a heuristic says about a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimate {
    /// About this much is left to do.
    Value(u32),
    /// No plan goes through this state.
    DeadEnd,
}

/// Estimates how far states are from the goal.
pub trait Heuristic {
    /// The estimate for a state.
    fn evaluate(&mut self, state: &State) -> Estimate;

    /// Operators that the last evaluation found helpful, in no particular order.
    fn preferred(&self) -> &[OperatorId];

    /// Whether letting time pass was helpful in the last evaluation.
    fn prefers_waiting(&self) -> bool;
}
