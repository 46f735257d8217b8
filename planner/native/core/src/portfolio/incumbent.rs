//! The best plan so far, which all searches share.

use std::time::Instant;

use crate::epoch::search::Found;
use crate::epoch::transitions::Transitions;
use crate::outcome::Outcome;
use crate::plan::{EPSILON, Plan};
use crate::schedule::Promptness;
use crate::solve::{FoundPlan, SolveReport};
use crate::task::{OperatorId, Task};

use super::exchange::Exchange;

/// Collects improving plans into the report and hands them on.
pub struct Incumbent<'a> {
    task: &'a Task,
    begun: Instant,
    /// The report under construction.
    pub report: &'a mut SolveReport,
    improved: &'a mut dyn FnMut(&Plan),
    promptness: Option<Promptness>,
    /// The best plan, and its operators by start.
    best: Option<Found>,
    operators: Vec<OperatorId>,
    /// Where other threads are told and heard, and up to which version.
    exchange: Option<(&'a Exchange, u64)>,
}

impl<'a> Incumbent<'a> {
    /// No plan yet.
    #[must_use]
    pub fn new(
        task: &'a Task,
        begun: Instant,
        report: &'a mut SolveReport,
        improved: &'a mut dyn FnMut(&Plan),
        promptness: Option<Promptness>,
    ) -> Self {
        Self {
            task,
            begun,
            report,
            improved,
            promptness,
            best: None,
            operators: Vec::new(),
            exchange: None,
        }
    }

    /// Shares plans with other threads from now on.
    #[must_use]
    pub(super) fn shared_by(mut self, exchange: &'a Exchange) -> Self {
        self.exchange = Some((exchange, 0));
        self
    }

    /// Takes the best plan of the other threads if it is better than all before.
    pub(super) fn import(&mut self) -> bool {
        let Some((exchange, seen)) = &mut self.exchange else {
            return false;
        };
        let newer = exchange.newer(seen);
        newer.is_some_and(|found| self.offer(&found))
    }

    /// Whether there is a plan.
    #[must_use]
    pub fn exists(&self) -> bool {
        !self.report.plans.is_empty()
    }

    /// The makespan below which plans are of interest [s]: none is worth less than its makespan.
    /// Infinite where something else is minimised.
    #[must_use]
    pub fn bound(&self) -> f64 {
        match self.report.plans.last() {
            Some(best) if self.task.metric.is_none() => best.cost,
            _ => f64::INFINITY,
        }
    }

    /// The best plan.
    #[must_use]
    pub fn best(&self) -> Option<&Found> {
        self.best.as_ref()
    }

    /// The operators of the best plan by start.
    #[must_use]
    pub fn operators(&self) -> &[OperatorId] {
        &self.operators
    }

    /// Takes a plan of the list-schedule search after executing it in the other space, which shares
    /// no code with it; false if it is not valid.
    pub fn offer_checked(&mut self, transitions: &Transitions<'_>, found: &Found) -> bool {
        let valid = transitions
            .execute(&found.steps)
            .is_some_and(|state| transitions.is_goal(&state));
        if valid {
            self.offer(found);
        }
        valid
    }

    /// What a plan of either search is worth.
    fn cost(&self, found: &Found) -> f64 {
        let Some(promptness) = &self.promptness else {
            return found.cost;
        };
        let steps = found.steps.iter();
        let ends =
            steps.map(|(operator, start, length)| (*operator, start + length.unwrap_or(0.0)));
        let makespan = ends.clone().map(|(_, end)| end).fold(0.0, f64::max);
        makespan + promptness.cost(ends)
    }

    fn improves(&self, cost: f64, over: f64) -> bool {
        if self.task.metric.as_ref().is_some_and(|m| m.maximise) {
            cost > over + 1e-9
        } else {
            cost < over - 1e-9
        }
    }

    /// Takes a plan if it is better than all before.
    pub fn offer(&mut self, found: &Found) -> bool {
        let cost = self.cost(found);
        let last = self.report.plans.last();
        let better = last.is_none_or(|best| self.improves(cost, best.cost));
        if !better || cost.is_nan() {
            return false;
        }
        if let Some((exchange, _)) = self.exchange {
            exchange.publish(found, |best| self.improves(cost, self.cost(best)));
        }
        let plan = found.plan(self.task);
        (self.improved)(&plan);
        self.operators = found.steps.iter().map(|step| step.0).collect();
        self.best = Some(found.clone());
        self.report.plans.push(FoundPlan {
            plan,
            cost,
            wall_s: self.begun.elapsed().as_secs_f64(),
        });
        true
    }

    /// Epsilons that separate the steps of the best plan [s]: differences this small do not count.
    fn slack(&self) -> f64 {
        let steps = self
            .report
            .plans
            .last()
            .map_or(0, |best| best.plan.steps.len());
        EPSILON * (steps + 1) as f64
    }

    /// Whether the best plan meets the lower bound, epsilons aside.
    #[must_use]
    pub fn is_optimal(&self) -> bool {
        self.exists() && self.bound() <= self.report.lower_bound + self.slack()
    }

    /// Notes how the search ended; exhausting the space may have raised the lower bound.
    pub fn close(&mut self, outcome: Outcome) {
        self.report.limit = outcome.limit();
        self.report.outcome = match outcome {
            Outcome::SolvedOptimally => {
                let proved = self.bound() - self.slack();
                if proved.is_finite() {
                    self.report.lower_bound = self.report.lower_bound.max(proved);
                }
                outcome
            }
            _ if self.exists() => Outcome::Solved,
            _ => outcome,
        };
    }
}
