//! From a domain and a problem to plans.

use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::attachment::{AttachmentError, Attachments};
use crate::grounding::{GaveUp, GroundingError, GroundingLimits, ground, ground_partially};
use crate::heuristic::choice::Choice;
use crate::outcome::Outcome;
use crate::pddl::model::{Domain, Problem};
use crate::plan::Plan;
use crate::portfolio;
use crate::progress::Progress;
pub use crate::report::{FoundPlan, SolveReport};
use crate::task::Task;

/// What bounds and steers a run.
#[derive(Clone, Copy, Debug)]
pub struct SolveOptions<'a> {
    /// Wall-clock time from the call on, grounding included; `None` is until done.
    pub timeout: Option<Duration>,
    /// CPU time of this process, counted from its start, by which the caller stops the search. Only
    /// how the time is divided depends on it.
    pub cpu_deadline: Option<Duration>,
    /// Seed of all random choices.
    pub seed: u64,
    /// Threads that search; with one, a seed and a node limit the same input gives the same plans.
    pub threads: usize,
    /// Expansions and lists tried, together, after which to stop.
    pub node_limit: Option<u64>,
    /// Bytes that the task and searching may hold.
    pub memory_limit: usize,
    /// Set by another thread to stop; noticed within milliseconds but for passes over very large
    /// tables.
    pub cancel: Option<&'a AtomicBool>,
    /// Whether to stop at the first plan.
    pub first_plan_only: bool,
    /// The plan in execution, its times counted from now; what is left of it may be the first plan.
    pub warm_start: Option<&'a Plan>,
    /// Weight of the mean time at which goals are reached, beside the makespan; 0 for the makespan
    /// alone. What counts where a plan covers only the goals known so far.
    pub promptness: f64,
    /// Told the report of a search that a limit or a request ended, before its tables are given
    /// back: for large problems that alone takes tens of milliseconds. Not told of other ends.
    pub stopped: Option<Stopped<'a>>,
    /// Where to tell what has been done so far.
    pub progress: Option<&'a Progress>,
    /// What guides the decision-epoch search; `None` leaves it to the portfolio.
    pub heuristic: Option<Choice>,
    /// Which spaces are searched.
    pub space: Space,
    /// Instantiations waiting at a time beyond which a problem is grounded in parts.
    pub whole_below: usize,
}

/// Who is told of a search that a limit or a request ended.
#[derive(Clone, Copy)]
pub struct Stopped<'a>(pub &'a (dyn Fn(&SolveReport) + Sync));

impl std::fmt::Debug for Stopped<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Stopped")
    }
}

/// Which spaces are searched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// List schedules and decision epochs, and while there is no plan also sequences of steps.
    #[default]
    Portfolio,
    /// Decision epochs alone.
    DecisionEpochs,
}

impl Space {
    /// All, with the names that users give.
    pub const NAMES: [(&'static str, Self); 2] = [
        ("portfolio", Self::Portfolio),
        ("decision-epochs", Self::DecisionEpochs),
    ];

    /// The spaces of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let entry = Self::NAMES.iter().find(|entry| entry.0 == name)?;
        Some(entry.1)
    }
}

impl Default for SolveOptions<'_> {
    fn default() -> Self {
        Self {
            timeout: Some(Duration::from_secs(10)),
            cpu_deadline: None,
            seed: 0,
            threads: 1,
            node_limit: None,
            memory_limit: 2 << 30,
            cancel: None,
            first_plan_only: false,
            warm_start: None,
            promptness: 0.0,
            stopped: None,
            progress: None,
            heuristic: None,
            space: Space::Portfolio,
            whole_below: 1_000_000,
        }
    }
}

/// Why a run failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// Grounding failed.
    #[error(transparent)]
    Grounding(GroundingError),
    /// An attachment failed.
    #[error(transparent)]
    Attachment(#[from] AttachmentError),
}

/// How many alike facts a partial grounding goes on from: wider where that finds no plan, and once
/// more when there is one. Afterwards everything is grounded.
const WIDTHS: [u32; 4] = [2, 6, 12, 32];

/// What an instantiation that waits to be looked at takes, with the attachment calls it brings, and
/// what of the memory that may be.
const CANDIDATE_BYTES: usize = 200;
const CANDIDATE_SHARE: usize = 2;

/// What an operator takes in the task at least, with what every search needs: measured.
const LEAST_OPERATOR_BYTES: usize = 2_000;

/// Solves a problem and calls `improved` with every improving plan as soon as it is found.
///
/// # Errors
/// A fault of an attachment, or a problem that cannot be grounded. Running out of time or memory
/// is an [`Outcome`].
pub fn solve(
    domain: &Domain,
    problem: &Problem,
    attachments: &dyn Attachments,
    options: &SolveOptions<'_>,
    improved: &mut dyn FnMut(&Plan),
) -> Result<SolveReport, SolveError> {
    let begun = Instant::now();
    let fitting = options.memory_limit / LEAST_OPERATOR_BYTES;
    let most = GroundingLimits::default().operators;
    let found: RefCell<Option<SolveReport>> = RefCell::new(None);
    let told = Cell::new(false);
    let gave_up = |error: &GroundingError| {
        if let (Some(stopped), Some(outcome)) = (options.stopped, gave_up_by(error))
            && !told.replace(true)
        {
            stopped.0(&ended(outcome, begun, found.borrow().clone()));
        }
    };
    let limits = GroundingLimits {
        gave_up: Some(GaveUp(&gave_up)),
        operators: most.min(fitting),
        deadline: options.timeout.map(|timeout| begun + timeout),
        cancel: options.cancel,
        ..GroundingLimits::default()
    };
    let whole = GroundingLimits {
        candidates: options
            .whole_below
            .min(options.memory_limit / CANDIDATE_SHARE / CANDIDATE_BYTES),
        ..limits
    };
    let mut grounded = ground(domain, problem, attachments, &whole);
    let mut widths = WIDTHS.iter();
    if fitting < most && matches!(grounded, Err(GroundingError::TooManyOperators { .. })) {
        // A part may fit.
        grounded = Err(GroundingError::TooManyCandidates);
    }
    loop {
        if matches!(grounded, Err(GroundingError::TooManyCandidates)) {
            grounded = match widths.next() {
                Some(width) => ground_partially(domain, problem, attachments, &limits, *width),
                None => ground(domain, problem, attachments, &limits),
            };
        }
        if let Some(outcome) = grounded.as_ref().err().and_then(gave_up_by) {
            return Ok(ended(outcome, begun, found.take()));
        }
        let task = match (grounded, found.take()) {
            (Ok(task), Some(narrow)) => {
                return widened(&task, attachments, options, begun, narrow, improved);
            }
            (Ok(task), None) => task,
            (Err(GroundingError::TooManyOperators { .. }), narrow) if fitting < most => {
                return Ok(ended(Outcome::OutOfMemory, begun, narrow));
            }
            (Err(GroundingError::Attachment(error)), _) => {
                return Err(SolveError::Attachment(error));
            }
            (Err(error), _) => return Err(SolveError::Grounding(error)),
        };
        // In a narrow part territories are nearly fixed: a first plan comes soon, good ones do not.
        let narrow = SolveOptions {
            first_plan_only: options.first_plan_only || task.partial,
            ..*options
        };
        let report = solve_task(&task, attachments, &narrow, begun, improved)?;
        if !task.partial || report.limit.is_some() || options.first_plan_only && has_plan(&report) {
            return Ok(report);
        }
        found.replace(has_plan(&report).then_some(report));
        if let Some(progress) = options.progress {
            progress.widen();
        }
        grounded = Err(GroundingError::TooManyCandidates);
    }
}

/// The outcome of a run whose grounding a limit or a request ended.
fn gave_up_by(error: &GroundingError) -> Option<Outcome> {
    match error {
        GroundingError::TimedOut => Some(Outcome::TimedOut),
        GroundingError::Cancelled => Some(Outcome::Cancelled),
        _ => None,
    }
}

fn has_plan(report: &SolveReport) -> bool {
    !report.plans.is_empty()
}

/// Searches a wider part for plans that are better than what a narrower one gave.
fn widened(
    task: &Task,
    attachments: &dyn Attachments,
    options: &SolveOptions<'_>,
    begun: Instant,
    narrow: SolveReport,
    improved: &mut dyn FnMut(&Plan),
) -> Result<SolveReport, SolveError> {
    let Some(known) = narrow.plans.last().cloned() else {
        return solve_task(task, attachments, options, begun, improved);
    };
    let spent = narrow.expansions + narrow.schedules;
    let told = |report: &SolveReport| {
        if let Some(stopped) = options.stopped {
            stopped.0(&joined(&narrow, &known, report.clone()));
        }
    };
    let options = SolveOptions {
        warm_start: Some(&known.plan),
        node_limit: options
            .node_limit
            .map(|limit| limit.saturating_sub(spent).max(1)),
        stopped: Some(Stopped(&told)),
        ..*options
    };
    let report = solve_task(task, attachments, &options, begun, &mut |plan| {
        if *plan != known.plan {
            improved(plan);
        }
    })?;
    Ok(joined(&narrow, &known, report))
}

/// What a narrower and a wider part gave together; `known` is the narrower one's best plan.
fn joined(narrow: &SolveReport, known: &FoundPlan, wide: SolveReport) -> SolveReport {
    let mut report = wide;
    report.plans.retain(|found| found.cost < known.cost - 1e-9);
    report.plans.splice(0..0, narrow.plans.iter().cloned());
    report.expansions += narrow.expansions;
    report.evaluations += narrow.evaluations;
    report.schedules += narrow.schedules;
    report.grounding_s += narrow.grounding_s;
    report.outcome = Outcome::Solved;
    report
}

/// The report of a run that ended while it grounded, with what it had found before.
fn ended(outcome: Outcome, begun: Instant, found: Option<SolveReport>) -> SolveReport {
    match found {
        Some(report) => SolveReport {
            limit: outcome.limit(),
            ..report
        },
        None => empty(outcome, begun),
    }
}

/// Solves a grounded task; `begun` is when the clock started.
///
/// # Errors
/// A fault of an attachment.
pub fn solve_task(
    task: &Task,
    attachments: &dyn Attachments,
    options: &SolveOptions<'_>,
    begun: Instant,
    improved: &mut dyn FnMut(&Plan),
) -> Result<SolveReport, SolveError> {
    let mut report = empty(Outcome::ProvenUnsolvable, begun);
    report.operators = task.operators.len();
    report.facts = task.facts.len();
    if let Some(progress) = options.progress {
        progress.tell(report.counts());
    }
    let told = |report: &SolveReport| {
        if let Some(stopped) = options.stopped {
            let mut report = report.clone();
            without_proof(task, &mut report);
            stopped.0(&report);
        }
    };
    let options = &SolveOptions {
        stopped: Some(Stopped(&told)),
        ..*options
    };
    if !task.unsolvable {
        portfolio::run(task, attachments, options, begun, &mut report, improved)?;
    }
    without_proof(task, &mut report);
    Ok(report)
}

/// A part of a problem proves nothing about the whole.
fn without_proof(task: &Task, report: &mut SolveReport) {
    if task.partial {
        report.lower_bound = 0.0;
        report.outcome = match report.outcome {
            Outcome::ProvenUnsolvable => Outcome::Exhausted,
            Outcome::SolvedOptimally => Outcome::Solved,
            other => other,
        };
    }
}

fn empty(outcome: Outcome, begun: Instant) -> SolveReport {
    SolveReport {
        outcome,
        limit: outcome.limit(),
        plans: Vec::new(),
        lower_bound: 0.0,
        expansions: 0,
        evaluations: 0,
        schedules: 0,
        operators: 0,
        facts: 0,
        grounding_s: begun.elapsed().as_secs_f64(),
    }
}

impl SolveOptions<'_> {
    /// Whether to stop now, by time or by request.
    #[must_use]
    pub fn interrupted(&self, begun: Instant) -> Option<Outcome> {
        if self
            .cancel
            .is_some_and(|cancel| cancel.load(Ordering::Relaxed))
        {
            return Some(Outcome::Cancelled);
        }
        (self
            .timeout
            .is_some_and(|timeout| begun.elapsed() >= timeout))
        .then_some(Outcome::TimedOut)
    }
}
