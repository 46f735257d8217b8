//! Runs the search spaces on one task, sharing the best plan and the lower bound.

use std::time::Instant;

use crate::attachment::Attachments;
use crate::epoch::calls::Calls;
use crate::epoch::compiled::Compiled;
use crate::epoch::completeness::{Completeness, analyse};
use crate::epoch::registry::Dominance;
use crate::epoch::search::{Parameters, Search, Status};
use crate::epoch::state::{State, Transitions};
use crate::epoch::successors::Successors;
use crate::heuristic::critical_path::makespan_bound;
use crate::heuristic::relaxed::RelaxedTask;
use crate::heuristic::relaxed_plan::RelaxedPlan;
use crate::outcome::Outcome;
use crate::plan::{EPSILON, Plan};
use crate::solve::{FoundPlan, SolveError, SolveOptions, SolveReport};
use crate::task::Task;

/// Plans this close to the lower bound are optimal apart from epsilons, one for each step.
fn epsilons(plan: &Plan) -> f64 {
    EPSILON * (plan.steps.len() + 1) as f64
}

/// The plans found so far.
pub struct Incumbent<'a> {
    begun: Instant,
    task: &'a Task,
    report: &'a mut SolveReport,
    improved: &'a mut dyn FnMut(&Plan),
}

impl Incumbent<'_> {
    /// The cost to beat.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.report.plans.last().map_or(f64::INFINITY, |p| p.cost)
    }

    /// Takes a plan if it is better than all before.
    pub fn offer(&mut self, plan: Plan) -> bool {
        let cost = plan.makespan();
        if self.task.metric.is_none() && cost >= self.cost() - 1e-9 {
            return false;
        }
        (self.improved)(&plan);
        self.report.plans.push(FoundPlan {
            plan,
            cost,
            wall_s: self.begun.elapsed().as_secs_f64(),
        });
        true
    }

    /// Whether the best plan meets the lower bound.
    #[must_use]
    pub fn is_optimal(&self) -> bool {
        self.task.metric.is_none()
            && self
                .report
                .plans
                .last()
                .is_some_and(|best| best.cost <= self.report.lower_bound + epsilons(&best.plan))
    }
}

/// Searches until done or stopped and fills the report.
///
/// # Errors
/// A fault of an attachment.
pub fn run(
    task: &Task,
    attachments: &dyn Attachments,
    options: &SolveOptions<'_>,
    begun: Instant,
    report: &mut SolveReport,
    improved: &mut dyn FnMut(&Plan),
) -> Result<(), SolveError> {
    let compiled = Compiled::new(task);
    let relaxed = RelaxedTask::new(task);
    let successors = Successors::new(&compiled);
    let completeness = analyse(task);
    let calls = Calls::new(task, attachments);
    let transitions = Transitions {
        compiled: &compiled,
        calls: &calls,
    };
    let bound = makespan_bound(&compiled, &relaxed);
    if bound.is_infinite() {
        report.outcome = Outcome::ProvenUnsolvable;
        return Ok(());
    }
    if task.metric.is_none() {
        report.lower_bound = bound;
    }
    let mut incumbent = Incumbent {
        begun,
        task,
        report,
        improved,
    };
    if transitions.is_goal(&State::initial(&compiled)) {
        incumbent.offer(Plan::default());
        incumbent.report.outcome = Outcome::SolvedOptimally;
        return Ok(());
    }
    let mut search = Search::new(
        transitions,
        &successors,
        Box::new(RelaxedPlan::new(&compiled, &relaxed)),
        Parameters {
            time_weight: 0.0,
            seed: options.seed,
            dominance: dominance(task, &completeness),
            tolerance: 20.0 * EPSILON,
            memory: options.memory_limit,
        },
    );
    let mut outcome;
    loop {
        let status = search.run(256, &mut |plan| {
            incumbent.offer(plan);
        });
        if let Some(error) = calls.failure() {
            return Err(error.into());
        }
        if let Some(progress) = options.progress {
            progress.tell(search.statistics.expansions, incumbent.report.lower_bound);
        }
        outcome = match status {
            Status::Exhausted => exhausted(&incumbent, &completeness, search.chose_duration),
            Status::MemoryFull => Outcome::OutOfMemory,
            Status::Interrupted | Status::Found => {
                let nodes = search.statistics.expansions;
                if incumbent.is_optimal() {
                    Outcome::SolvedOptimally
                } else if let Some(outcome) = options.interrupted(begun) {
                    outcome
                } else if options.node_limit.is_some_and(|limit| nodes >= limit)
                    || (options.first_plan_only && incumbent.cost().is_finite())
                {
                    Outcome::TimedOut
                } else {
                    continue;
                }
            }
        };
        break;
    }
    let solved = !incumbent.report.plans.is_empty();
    if solved && outcome != Outcome::SolvedOptimally {
        outcome = Outcome::Solved;
    }
    if outcome == Outcome::SolvedOptimally && task.metric.is_none() {
        let best = incumbent.cost();
        let report = &mut incumbent.report;
        report.lower_bound = report
            .lower_bound
            .max(best - epsilons(&report.plans[report.plans.len() - 1].plan));
    }
    report.outcome = outcome;
    report.expansions = search.statistics.expansions;
    report.evaluations = search.statistics.evaluations;
    Ok(())
}

fn exhausted(incumbent: &Incumbent<'_>, completeness: &Completeness, chose: bool) -> Outcome {
    if incumbent.cost().is_finite() {
        if completeness.keeps_optima && !chose {
            Outcome::SolvedOptimally
        } else {
            Outcome::Solved
        }
    } else if completeness.finds_plans && !chose {
        Outcome::ProvenUnsolvable
    } else {
        Outcome::Exhausted
    }
}

fn dominance(task: &Task, completeness: &Completeness) -> Dominance {
    if completeness.earlier_is_better {
        Dominance::Earlier
    } else if task.timed.is_empty() {
        Dominance::Shifted
    } else {
        Dominance::Same
    }
}
