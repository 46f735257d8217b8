//! A search in a thread of its own: Python waits without the GIL, sees signals, and gets plans as they come.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use planner_core::heuristic::choice::Choice;
use planner_core::outcome::{Limit, Outcome};
use planner_core::pddl::model;
use planner_core::plan::Plan;
use planner_core::progress::Progress;
use planner_core::solve::{SolveError, SolveOptions, SolveReport, Space, Stopped, solve};
use planner_core::validate::{Options, Reason, Validator, Verdict};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::attachments::{FailedCall, PythonAttachments, failed_call};
use crate::model::Problem;
use crate::overdue::Overdue;
use crate::panic::caught;
use crate::plan::{StepTuple, from_tuples, to_tuples};
use crate::report::Report;

/// How often a waiting Python thread looks for signals.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(20);

/// How often an overdue search is asked for while an attachment keeps it.
const RETRY: Duration = Duration::from_millis(1);

/// Smallest time between interfering happenings that our own plans keep [s].
const SEPARATION_S: f64 = 0.001;

/// What bounds and steers a search; see `planner.solve`.
#[derive(Clone)]
struct Settings {
    timeout: Option<Duration>,
    cpu_deadline: Option<Duration>,
    seed: u64,
    threads: usize,
    node_limit: Option<u64>,
    memory_limit: Option<usize>,
    first_plan_only: bool,
    warm_start: Option<Plan>,
    heuristic: Option<Choice>,
    space: Space,
    promptness: f64,
}

/// Something that a search tells.
#[pyclass(frozen, get_all, module = "planner._core")]
pub struct Event {
    /// An improving plan: steps, value of the metric, seconds since the call.
    plan: Option<(Vec<StepTuple>, Option<f64>, f64)>,
    /// The end of the search.
    report: Option<Report>,
    /// An attachment that failed, and its exception.
    attachment: Option<FailedCall>,
    exception: Option<Py<PyAny>>,
    /// Why the problem cannot be planned with.
    refused: Option<String>,
    /// A fault of the planner.
    internal: Option<String>,
}

enum Message {
    Plan(Vec<StepTuple>, Option<f64>, f64),
    End(Report),
    Attachment(FailedCall),
    Refused(String),
    Internal(String),
}

/// A running search.
#[pyclass(frozen, module = "planner._core")]
pub struct Search {
    messages: Mutex<Receiver<Message>>,
    cancel: Arc<AtomicBool>,
    progress: Arc<Progress>,
    attachments: Arc<PythonAttachments>,
    overdue: Overdue,
    /// What the messages heard so far say.
    heard: Mutex<Heard>,
}

/// What messages said.
#[derive(Clone, Copy, Default)]
struct Heard {
    plan: bool,
    end: bool,
}

#[pymethods]
impl Search {
    /// Starts searching.
    #[new]
    #[pyo3(signature = (problem, attachments, *, timeout_s, cpu_timeout_s, seed, threads, node_limit, memory_limit,
        first_plan_only, warm_start, heuristic, space, promptness))]
    #[allow(clippy::too_many_arguments)] // keywords of one Python call
    fn new(
        problem: &Problem,
        attachments: &Bound<'_, PyDict>,
        timeout_s: Option<f64>,
        cpu_timeout_s: Option<f64>,
        seed: u64,
        threads: usize,
        node_limit: Option<u64>,
        memory_limit: Option<usize>,
        first_plan_only: bool,
        warm_start: Option<Vec<StepTuple>>,
        heuristic: Option<&str>,
        space: &str,
        promptness: f64,
    ) -> PyResult<Self> {
        let domain = Arc::clone(&problem.domain.get().model);
        let problem = Arc::clone(&problem.model);
        let attachments = Arc::new(PythonAttachments::new(attachments, &domain, &problem)?);
        let cancel = Arc::new(AtomicBool::new(false));
        let settings = Settings {
            timeout: timeout_s.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
            cpu_deadline: cpu_timeout_s.and_then(|s| Duration::try_from_secs_f64(s).ok()),
            seed,
            threads,
            node_limit,
            memory_limit,
            first_plan_only,
            warm_start: warm_start.map(from_tuples),
            heuristic: heuristic.map(chosen).transpose()?,
            space: Space::named(space)
                .ok_or_else(|| PyValueError::new_err(format!("no space is called {space}")))?,
            promptness,
        };
        let progress = Arc::new(Progress::default());
        let (sender, messages) = channel();
        let search = Self {
            messages: Mutex::new(messages),
            cancel: Arc::clone(&cancel),
            progress: Arc::clone(&progress),
            attachments: Arc::clone(&attachments),
            overdue: Overdue::after(settings.timeout),
            heard: Mutex::new(Heard::default()),
        };
        std::thread::Builder::new()
            .name("marsupial search".into())
            .stack_size(16 << 20)
            .spawn(move || {
                let signals = Signals {
                    cancel: &cancel,
                    progress: &progress,
                    sender: &sender,
                };
                let run = || run(&domain, &problem, &attachments, &settings, signals);
                if let Err(panic) = caught(run) {
                    let _ = sender.send(Message::Internal(panic));
                }
            })?;
        Ok(search)
    }

    /// The next event; `None` if there was none for `timeout_s` or the search is over.
    fn next(&self, py: Python<'_>, timeout_s: f64) -> PyResult<Option<Event>> {
        let deadline = Instant::now() + Duration::from_secs_f64(timeout_s.clamp(0.0, 1e6));
        loop {
            if lock(&self.heard).end {
                return Ok(None);
            }
            let left = deadline.saturating_duration_since(Instant::now());
            let overdue = self.overdue.left();
            let wait = overdue.map_or(SIGNAL_INTERVAL, |(left, _)| left.max(RETRY));
            let received = py.detach(|| {
                let messages = lock(&self.messages);
                messages.recv_timeout(left.min(SIGNAL_INTERVAL).min(wait))
            });
            if let Err(interrupt) = py.check_signals() {
                self.cancel();
                return Err(interrupt);
            }
            match received {
                Ok(message) => return Ok(Some(self.event(py, message))),
                Err(RecvTimeoutError::Disconnected) => return Ok(None),
                Err(RecvTimeoutError::Timeout)
                    if let Some((Duration::ZERO, limit)) = overdue
                        && self.attachments.close() =>
                {
                    return Ok(Some(self.event(py, self.given_up(limit))));
                }
                Err(RecvTimeoutError::Timeout) if left.is_zero() => return Ok(None),
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }

    /// States expanded and plans built so far, and the lower bound.
    fn progress(&self) -> (u64, f64) {
        let counts = self.progress.counts();
        (counts.expansions + counts.schedules, counts.lower_bound)
    }

    /// Asks it to stop; its end is told within 50 ms, unless an attachment takes longer.
    fn cancel(&self) {
        self.overdue.cancel();
        self.cancel.store(true, Ordering::Relaxed);
    }
}

impl Drop for Search {
    fn drop(&mut self) {
        self.cancel();
    }
}

impl Search {
    fn event(&self, py: Python<'_>, message: Message) -> Event {
        let mut event = Event {
            plan: None,
            report: None,
            attachment: None,
            exception: None,
            refused: None,
            internal: None,
        };
        let mut heard = lock(&self.heard);
        match message {
            Message::Plan(..) => heard.plan = true,
            _ => heard.end = true,
        }
        drop(heard);
        match message {
            Message::Plan(steps, metric, wall_s) => event.plan = Some((steps, metric, wall_s)),
            Message::End(report) => event.report = Some(report),
            Message::Refused(reason) => event.refused = Some(reason),
            Message::Internal(reason) => event.internal = Some(reason),
            Message::Attachment(call) => {
                event.attachment = Some(call);
                event.exception = self
                    .attachments
                    .exception()
                    .map(|error| error.into_value(py).into_any());
            }
        }
        event
    }

    /// The end of a search that does not tell it in time.
    fn given_up(&self, limit: Limit) -> Message {
        self.cancel.store(true, Ordering::Relaxed);
        let outcome = match limit {
            _ if lock(&self.heard).plan => Outcome::Solved,
            Limit::Time => Outcome::TimedOut,
            _ => Outcome::Cancelled,
        };
        Message::End(Report::new(outcome, Some(limit), &self.progress.counts()))
    }
}

/// The value, also where its last user panicked.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The heuristic of a name.
fn chosen(name: &str) -> PyResult<Choice> {
    Choice::named(name)
        .ok_or_else(|| PyValueError::new_err(format!("no heuristic is called {name}")))
}

/// How a search and whoever waits for it talk to each other.
#[derive(Clone, Copy)]
struct Signals<'a> {
    cancel: &'a AtomicBool,
    progress: &'a Progress,
    sender: &'a Sender<Message>,
}

/// Searches, validates every plan before it leaves, and tells how it ended.
fn run(
    domain: &model::Domain,
    problem: &model::Problem,
    attachments: &PythonAttachments,
    settings: &Settings,
    signals: Signals<'_>,
) {
    let Signals {
        cancel,
        progress,
        sender,
    } = signals;
    let begun = Instant::now();
    let defaults = SolveOptions::default();
    let options = SolveOptions {
        timeout: settings.timeout,
        cpu_deadline: settings.cpu_deadline,
        seed: settings.seed,
        threads: settings.threads,
        node_limit: settings.node_limit,
        memory_limit: settings.memory_limit.unwrap_or(defaults.memory_limit),
        cancel: Some(cancel),
        first_plan_only: settings.first_plan_only,
        warm_start: settings.warm_start.as_ref(),
        promptness: settings.promptness,
        progress: Some(progress),
        heuristic: settings.heuristic,
        space: settings.space,
        ..defaults
    };
    let validator = Validator::new(domain, problem, attachments);
    let rejected = Mutex::new(None);
    let told = AtomicBool::new(false);
    let stopped = |report: &SolveReport| {
        if lock(&rejected).is_none() {
            told.store(true, Ordering::Relaxed);
            let _ = sender.send(Message::End(Report::from(report)));
            std::thread::yield_now();
        }
    };
    let options = SolveOptions {
        stopped: Some(Stopped(&stopped)),
        ..options
    };
    let outcome = solve(domain, problem, attachments, &options, &mut |plan| {
        if lock(&rejected).is_some() {
            return;
        }
        let verdict = validator.validate(plan, &Options::strict(SEPARATION_S));
        if verdict.valid() {
            let wall_s = begun.elapsed().as_secs_f64();
            let _ = sender.send(Message::Plan(to_tuples(plan), verdict.metric, wall_s));
            // Whoever waits for it shall not have to wait for a time slice too.
            std::thread::yield_now();
        } else {
            cancel.store(true, Ordering::Relaxed);
            *lock(&rejected) = Some(rejection(plan, verdict));
        }
    });
    if told.load(Ordering::Relaxed) {
        return;
    }
    let _ = sender.send(match (lock(&rejected).take(), outcome) {
        (Some(message), _) => message,
        (None, Ok(report)) => Message::End(Report::from(&report)),
        (None, Err(SolveError::Attachment(error))) => Message::Attachment(failed_call(&error)),
        (None, Err(error)) => Message::Refused(error.to_string()),
    });
}

/// A plan of ours that the validator rejects never leaves; an attachment that failed meanwhile is no fault of ours.
fn rejection(plan: &Plan, verdict: Verdict) -> Message {
    match verdict.failure {
        Some(failure) => match &failure.reason {
            Reason::Attachment(error) => Message::Attachment(failed_call(error)),
            _ => Message::Internal(format!(
                "the validator rejects a plan of {} steps: {failure}",
                plan.steps.len()
            )),
        },
        None => Message::Internal("a valid plan was rejected".into()),
    }
}
