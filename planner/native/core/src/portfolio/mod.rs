//! Runs both search spaces on one task as one anytime portfolio that shares plan and bound.
//!
//! The list-schedule search goes first, because it finds the better plans; the decision-epoch search
//! goes first where actions may have to start inside others, takes over where the list space cannot
//! express the task, and is the one that proves by exhaustion.

mod alternation;
mod cpu_clock;
mod exchange;
mod incumbent;
mod prelude;
mod threads;
mod warm_start;

use std::time::Instant;

use crate::attachment::Attachments;
use crate::epoch::calls::Calls;
use crate::epoch::compiled::Compiled;
use crate::epoch::completeness::{Completeness, analyse};
use crate::epoch::registry::Dominance;
use crate::epoch::search::{Found, Parameters, Search};
use crate::epoch::successors::Successors;
use crate::epoch::transitions::Transitions;
use crate::heuristic::choice::Choice;
use crate::heuristic::context_enhanced_additive::Graphs;
use crate::heuristic::critical_path::makespan_bound;
use crate::heuristic::relaxed::RelaxedTask;
use crate::outcome::Outcome;
use crate::plan::{EPSILON, Plan};
use crate::progress::Counts;
use crate::schedule::{Optimiser, Promptness, Schedule};
use crate::solve::{SolveError, SolveOptions, SolveReport, Space};
use crate::task::Task;

use cpu_clock::CpuClock;
use incumbent::Incumbent;

/// Times that differ by less count as equal when states are compared: an order of epsilons is no
/// reason to keep two states.
const TOLERANCE: f64 = 20.0 * EPSILON;

/// What an operator takes in the task and the tables of all searches: 2,000 to 4,700 bytes measured.
const OPERATOR_BYTES: usize = 4_500;

/// What an operator takes besides in the tables of the search for sequences of steps.
const SEQUENTIAL_OPERATOR_BYTES: usize = 2_500;

/// Which thread a portfolio runs in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    /// The only one.
    Alone,
    /// The first of two, which does what a single one would do.
    First,
    /// The second of two, which begins with other searches.
    Second,
}

/// What the searches have in common.
struct Setting<'a> {
    task: &'a Task,
    attachments: &'a dyn Attachments,
    options: &'a SolveOptions<'a>,
    begun: Instant,
    cpu_clock: CpuClock,
    compiled: &'a Compiled<'a>,
    relaxed: &'a RelaxedTask,
    successors: &'a Successors,
    heuristic: Choice,
    graphs: Option<&'a Graphs>,
    completeness: Completeness,
    /// Weighs the mean goal time too; the decision-epoch search, which does not, then only finds a
    /// first plan.
    promptness: Option<Promptness>,
    role: Role,
}

impl<'a> Setting<'a> {
    fn calls(&self) -> Calls<'a> {
        Calls::new(self.task, self.attachments)
    }

    fn transitions<'s>(&'s self, calls: &'s Calls<'a>) -> Transitions<'s> {
        Transitions {
            compiled: self.compiled,
            calls,
        }
    }

    fn search<'s>(&'s self, calls: &'s Calls<'a>, seed: u64) -> Search<'s> {
        let transitions = self.transitions(calls);
        let parameters = Parameters {
            time_weight: 0.0,
            seed,
            dominance: self.dominance(),
            tolerance: TOLERANCE,
            memory: self.memory(),
        };
        let heuristics = self
            .heuristic
            .heuristics(self.compiled, self.relaxed, self.graphs);
        Search::new(transitions, self.successors, heuristics, parameters)
    }

    /// Bytes that states and open lists may take: what the task and its tables leave of the limit.
    fn memory(&self) -> usize {
        let limit = self.options.memory_limit;
        let tables = self.task.operators.len().saturating_mul(OPERATOR_BYTES);
        limit.saturating_sub(tables).max(limit / 4)
    }

    /// Whether the memory allows tables for sequences of steps beside all others.
    fn affords_sequences(&self) -> bool {
        let each = OPERATOR_BYTES + SEQUENTIAL_OPERATOR_BYTES;
        let tables = self.task.operators.len().saturating_mul(each);
        tables <= self.options.memory_limit
    }

    fn dominance(&self) -> Dominance {
        if self.completeness.earlier_is_better {
            Dominance::Earlier
        } else if self.task.timed.is_empty() {
            Dominance::Shifted
        } else {
            Dominance::Same
        }
    }

    /// When the time is used up, as far as can be told now.
    fn deadline(&self) -> Option<Instant> {
        let timeout = self.options.timeout.map(|timeout| self.begun + timeout);
        let used_up = self.cpu_clock.used_up(self.options);
        timeout.into_iter().chain(used_up).min()
    }

    fn interrupted(&self) -> Option<Outcome> {
        self.options.interrupted(self.begun)
    }

    /// How many nodes the limit leaves; very many if there is none.
    fn nodes_left(&self, spent: u64) -> u64 {
        let limit = self.options.node_limit;
        limit.map_or(u64::MAX >> 1, |limit| limit.saturating_sub(spent))
    }

    fn tell(&self, report: &SolveReport, expansions: u64) {
        if let Some(progress) = self.options.progress {
            let proves = !self.task.partial;
            progress.tell(Counts {
                expansions,
                lower_bound: if proves { report.lower_bound } else { 0.0 },
                ..report.counts()
            });
        }
    }

    /// Whether there is nothing more to do, and how it ended.
    fn over(&self, incumbent: &Incumbent<'_>, expansions: u64) -> Option<Outcome> {
        self.tell(incumbent.report, expansions);
        if incumbent.is_optimal() {
            return Some(Outcome::SolvedOptimally);
        }
        if self.options.first_plan_only && incumbent.exists() {
            return Some(Outcome::Solved);
        }
        let nodes = expansions + incumbent.report.schedules;
        if self.options.node_limit.is_some_and(|limit| nodes >= limit) {
            return Some(Outcome::OutOfNodes);
        }
        self.interrupted()
    }

    /// Tells how a limit ended the search, if one did.
    fn tell_stopped(&self, incumbent: &mut Incumbent<'_>, outcome: Outcome) {
        if outcome.limit().is_some() {
            close_stopped(self.options, incumbent, outcome);
        }
    }

    fn exhausted(&self, incumbent: &Incumbent<'_>, search: &Search<'_>) -> Outcome {
        self.exhausted_with(incumbent, search.chose_duration)
    }

    /// What an exhausted decision-epoch space proves.
    fn exhausted_with(&self, incumbent: &Incumbent<'_>, chose_duration: bool) -> Outcome {
        match (incumbent.exists(), chose_duration) {
            (true, false) if self.completeness.keeps_optima && self.promptness.is_none() => {
                Outcome::SolvedOptimally
            }
            (true, _) => Outcome::Solved,
            (false, false) if self.completeness.finds_plans => Outcome::ProvenUnsolvable,
            (false, _) => Outcome::Exhausted,
        }
    }
}

/// A list schedule as the portfolio's currency.
fn from_schedule(schedule: &Schedule) -> Found {
    Found {
        steps: schedule
            .operators
            .iter()
            .map(|entry| (entry.operator, entry.start, entry.duration))
            .collect(),
        cost: schedule.cost,
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
    let stop = || options.interrupted(begun).is_some();
    let promptness = Promptness::new(task, options.promptness);
    let mut incumbent = Incumbent::new(task, begun, report, improved, promptness.clone());
    let warm = options
        .warm_start
        .map(|plan| warm_start::operators(task, plan))
        .unwrap_or_default();
    let optimiser = || {
        let lists = options.space == Space::Portfolio;
        lists.then(|| Optimiser::new(task, options.seed, promptness.clone()))?
    };
    let mut early = None;
    if !warm.is_empty()
        && let Some(mut optimiser) = optimiser()
    {
        let limits = (
            options.timeout.map(|timeout| begun + timeout),
            options.cancel,
        );
        let world = (task, attachments);
        let sound = warm_start::put_in_force(&mut optimiser, &warm, world, limits, &mut incumbent);
        if options.first_plan_only && incumbent.exists() {
            incumbent.close(Outcome::Solved);
            return Ok(());
        }
        early = Some(sound.then_some(optimiser));
    }
    let stopped = |incumbent: &mut Incumbent<'_>| match options.interrupted(begun) {
        Some(outcome) => {
            close_stopped(options, &mut *incumbent, outcome);
            true
        }
        None => false,
    };
    let Some(compiled) = Compiled::unless(&stop, task) else {
        stopped(&mut incumbent);
        return Ok(());
    };
    let relaxed = RelaxedTask::new(task);
    if stopped(&mut incumbent) {
        return Ok(());
    }
    let successors = Successors::new(&compiled);
    let heuristic = options.heuristic.unwrap_or(Choice::TemporalFf);
    let graphs = heuristic.graphs(&stop, task, &relaxed);
    if stopped(&mut incumbent) {
        return Ok(());
    }
    let setting = Setting {
        task,
        attachments,
        options,
        begun,
        cpu_clock: CpuClock::start(),
        compiled: &compiled,
        relaxed: &relaxed,
        successors: &successors,
        heuristic,
        graphs: graphs.as_ref(),
        completeness: analyse(task),
        promptness: promptness.clone(),
        role: Role::Alone,
    };
    let bound = makespan_bound(&compiled, &relaxed);
    if stopped(&mut incumbent) {
        return Ok(());
    }
    if bound.is_infinite() {
        incumbent.close(Outcome::ProvenUnsolvable);
        return Ok(());
    }
    if task.metric.is_none() && !task.partial {
        incumbent.report.lower_bound = bound;
    }
    if is_solved_at_once(&setting) {
        incumbent.offer(&Found {
            steps: Vec::new(),
            cost: 0.0,
        });
        incumbent.close(Outcome::SolvedOptimally);
        return Ok(());
    }
    let optimiser = early.unwrap_or_else(optimiser);
    if stopped(&mut incumbent) {
        return Ok(());
    }
    let outcome = if options.threads > 1 && options.node_limit.is_none() {
        threads::run(&setting, optimiser, &warm, &mut incumbent)?
    } else {
        alternation::run(&setting, optimiser, &warm, &mut incumbent)?
    };
    incumbent.close(outcome);
    Ok(())
}

/// Closes the report of a search that a limit or a request ended, and tells it.
fn close_stopped(options: &SolveOptions<'_>, incumbent: &mut Incumbent<'_>, outcome: Outcome) {
    incumbent.close(outcome);
    if let Some(listener) = options.stopped {
        listener.0(incumbent.report);
    }
}

/// Whether the empty plan reaches the goal and nothing but the makespan counts.
fn is_solved_at_once(setting: &Setting<'_>) -> bool {
    let calls = setting.calls();
    let transitions = setting.transitions(&calls);
    setting.task.metric.is_none() && transitions.is_goal(&transitions.initial())
}
