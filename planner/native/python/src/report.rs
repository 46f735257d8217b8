//! How a search ended, for Python.

use planner_core::outcome::{Limit, Outcome};
use planner_core::progress::Counts;
use planner_core::solve::SolveReport;
use pyo3::prelude::*;

/// The end of a search.
#[pyclass(frozen, get_all, module = "planner._core")]
#[derive(Clone)]
pub struct Report {
    outcome: &'static str,
    /// `time`, `nodes`, `memory` or `cancelled`: what ended it before it was done.
    limit: Option<&'static str>,
    lower_bound: f64,
    expansions: u64,
    evaluations: u64,
    schedules: u64,
    operators: usize,
    facts: usize,
    grounding_s: f64,
}

impl Report {
    /// With what has been done until then.
    pub fn new(outcome: Outcome, limit: Option<Limit>, counts: &Counts) -> Self {
        Self {
            outcome: match outcome {
                Outcome::SolvedOptimally => "solved_optimally",
                Outcome::Solved => "solved",
                Outcome::ProvenUnsolvable => "proven_unsolvable",
                Outcome::Exhausted => "exhausted",
                Outcome::TimedOut => "timed_out",
                Outcome::OutOfNodes => "out_of_nodes",
                Outcome::OutOfMemory => "out_of_memory",
                Outcome::Cancelled => "cancelled",
            },
            limit: limit.map(|limit| match limit {
                Limit::Time => "time",
                Limit::Nodes => "nodes",
                Limit::Memory => "memory",
                Limit::Cancelled => "cancelled",
            }),
            lower_bound: counts.lower_bound,
            expansions: counts.expansions,
            evaluations: counts.evaluations,
            schedules: counts.schedules,
            operators: counts.operators,
            facts: counts.facts,
            grounding_s: counts.grounding_s,
        }
    }
}

impl From<&SolveReport> for Report {
    fn from(report: &SolveReport) -> Self {
        Self::new(report.outcome, report.limit, &report.counts())
    }
}
