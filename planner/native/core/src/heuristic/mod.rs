//! Heuristics of the decision-epoch search, one file each.
//!
//! | heuristic | admissible | preferred operators | numbers |
//! |---|---|---|---|
//! | [`relaxed_plan`] (FF over h_add) | no | yes | by repetition |
//! | [`critical_path`] (h_max over time) | for the makespan | no | ignored |
//! | [`blind`] | yes | no | ignored |

pub mod blind;
pub mod critical_path;
pub mod relaxed;
pub mod relaxed_plan;

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
