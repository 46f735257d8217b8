//! How a planning run ended.

/// Outcomes are values; faults (attachment errors, bad input) are errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// The best plan found is proved optimal.
    SolvedOptimally,
    /// A plan was found; a better one may exist.
    Solved,
    /// No plan exists.
    ProvenUnsolvable,
    /// The search space is exhausted without a plan, but it is not complete for this problem.
    Exhausted,
    /// The time limit was reached without a plan.
    TimedOut,
    /// The memory limit was reached without a plan.
    OutOfMemory,
    /// Somebody stopped the search before it had a plan.
    Cancelled,
}
