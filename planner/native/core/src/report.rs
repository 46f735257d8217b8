//! What a run gave.

use crate::outcome::{Limit, Outcome};
use crate::plan::Plan;
use crate::progress::Counts;

/// A plan and when it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundPlan {
    /// The plan.
    pub plan: Plan,
    /// Its value under the problem's metric; the makespan, with its share of the mean goal time, if
    /// there is none.
    pub cost: f64,
    /// Since the call [s].
    pub wall_s: f64,
}

/// The result of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveReport {
    /// How it ended.
    pub outcome: Outcome,
    /// The limit that ended it, with a plan or without.
    pub limit: Option<Limit>,
    /// Improving plans, the best last.
    pub plans: Vec<FoundPlan>,
    /// No plan has a smaller makespan (metric value) than this; 0 if nothing is known.
    pub lower_bound: f64,
    /// States whose successors were generated.
    pub expansions: u64,
    /// Heuristic evaluations.
    pub evaluations: u64,
    /// Plans built by the list-schedule search.
    pub schedules: u64,
    /// Ground operators.
    pub operators: usize,
    /// Ground facts that states store.
    pub facts: usize,
    /// Time for grounding [s].
    pub grounding_s: f64,
}

impl SolveReport {
    /// What was done, without how it ended.
    #[must_use]
    pub fn counts(&self) -> Counts {
        Counts {
            expansions: self.expansions,
            evaluations: self.evaluations,
            schedules: self.schedules,
            operators: self.operators,
            facts: self.facts,
            lower_bound: self.lower_bound,
            grounding_s: self.grounding_s,
        }
    }
}
