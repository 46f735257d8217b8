//! How a planning run ended.

/// Which limit ended a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Limit {
    /// Wall-clock time.
    Time,
    /// Expansions and lists tried.
    Nodes,
    /// Memory.
    Memory,
    /// None of its own: somebody asked it to stop.
    Cancelled,
}

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
    /// The node limit was reached without a plan.
    OutOfNodes,
    /// The memory limit was reached without a plan.
    OutOfMemory,
    /// Somebody stopped the search before it had a plan.
    Cancelled,
}

impl Outcome {
    /// The limit that it says was reached.
    #[must_use]
    pub const fn limit(self) -> Option<Limit> {
        match self {
            Self::TimedOut => Some(Limit::Time),
            Self::OutOfNodes => Some(Limit::Nodes),
            Self::OutOfMemory => Some(Limit::Memory),
            Self::Cancelled => Some(Limit::Cancelled),
            Self::SolvedOptimally | Self::Solved | Self::ProvenUnsolvable | Self::Exhausted => None,
        }
    }
}
