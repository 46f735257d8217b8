//! Two threads: the portfolio twice, the second time with another seed and in another order; they
//! share the best plan. The caller's thread collects plans and watches the limits.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use crate::epoch::search::Found;
use crate::outcome::Outcome;
use crate::plan::Plan;
use crate::schedule::Optimiser;
use crate::solve::{SolveError, SolveOptions, SolveReport};
use crate::task::OperatorId;

use super::exchange::Exchange;
use super::incumbent::Incumbent;
use super::{Role, Setting, alternation};

/// How long the collecting thread sleeps at most.
const PAUSE: Duration = Duration::from_millis(5);

/// What lies between the seeds of the threads.
const STRIDE: u64 = 0x9E37_79B9_7F4A_7C15;

/// How one portfolio ended, and its counts.
type Ended = (Result<Outcome, SolveError>, SolveReport);

/// Runs until an outcome is reached.
///
/// # Errors
/// A fault of an attachment.
pub(super) fn run(
    setting: &Setting<'_>,
    optimiser: Option<Optimiser<'_>>,
    warm: &[OperatorId],
    incumbent: &mut Incumbent<'_>,
) -> Result<Outcome, SolveError> {
    let stop = AtomicBool::new(false);
    let (to_collector, plans) = channel();
    let exchange = Exchange::new(to_collector);
    let (ended, endings) = channel();
    if let Some(best) = incumbent.best() {
        exchange.publish(best, |_| true);
    }
    let mut report = incumbent.report.clone();
    report.plans.clear();
    report.schedules = 0;
    let seed = setting.options.seed;
    let own_lists = optimiser.is_some();
    let outcome = std::thread::scope(|scope| {
        let (exchange, stop) = (&exchange, &stop);
        let (first, second) = ((report.clone(), ended.clone()), (report, ended));
        scope.spawn(move || {
            let own = Portfolio {
                role: Role::First,
                seed,
                exchange,
                stop,
            };
            own.work(setting, optimiser, warm, first);
        });
        scope.spawn(move || {
            let seed = seed.wrapping_add(STRIDE);
            let prompt = setting.promptness.clone();
            let optimiser = own_lists.then(|| Optimiser::new(setting.task, seed, prompt));
            let own = Portfolio {
                role: Role::Second,
                seed,
                exchange,
                stop,
            };
            own.work(setting, optimiser.flatten(), warm, second);
        });
        let outcome = collect(setting, &plans, &endings, incumbent);
        stop.store(true, Ordering::Relaxed);
        if let Ok(outcome) = outcome {
            setting.tell_stopped(incumbent, outcome);
        }
        outcome
    });
    for (_, report) in endings.try_iter() {
        count(incumbent, &report);
    }
    outcome
}

/// Adds what a portfolio did.
fn count(incumbent: &mut Incumbent<'_>, report: &SolveReport) {
    incumbent.report.expansions += report.expansions;
    incumbent.report.evaluations += report.evaluations;
    incumbent.report.schedules += report.schedules;
}

/// What one thread has of its own, and how it hears of the others.
struct Portfolio<'a> {
    role: Role,
    seed: u64,
    exchange: &'a Exchange,
    stop: &'a AtomicBool,
}

impl Portfolio<'_> {
    fn work(
        &self,
        setting: &Setting<'_>,
        optimiser: Option<Optimiser<'_>>,
        warm: &[OperatorId],
        (mut report, ended): (SolveReport, Sender<Ended>),
    ) {
        let options = SolveOptions {
            seed: self.seed,
            cancel: Some(self.stop),
            memory_limit: setting.options.memory_limit / 2,
            progress: None,
            stopped: None,
            ..*setting.options
        };
        let own = Setting {
            options: &options,
            role: self.role,
            promptness: setting.promptness.clone(),
            ..*setting
        };
        let mut unheard = |_: &Plan| {};
        let promptness = setting.promptness.clone();
        let (task, begun) = (setting.task, setting.begun);
        let mut incumbent = Incumbent::new(task, begun, &mut report, &mut unheard, promptness)
            .shared_by(self.exchange);
        let outcome = alternation::run(&own, optimiser, warm, &mut incumbent);
        // Nobody listens any more when the other portfolio was done first.
        drop(ended.send((outcome, report)));
    }
}

/// Takes plans until the first portfolio that is done for good, or both, or a limit.
fn collect(
    setting: &Setting<'_>,
    plans: &Receiver<Found>,
    endings: &Receiver<Ended>,
    incumbent: &mut Incumbent<'_>,
) -> Result<Outcome, SolveError> {
    let mut last = None;
    loop {
        match plans.recv_timeout(PAUSE) {
            Ok(found) => drop(incumbent.offer(&found)),
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {}
        }
        for found in plans.try_iter() {
            incumbent.offer(&found);
        }
        while let Ok((outcome, report)) = endings.try_recv() {
            for found in plans.try_iter() {
                incumbent.offer(&found);
            }
            count(incumbent, &report);
            let outcome = outcome?;
            let settled = !matches!(outcome, Outcome::Exhausted | Outcome::OutOfMemory);
            if settled || last.is_some() {
                return Ok(outcome);
            }
            last = Some(outcome);
        }
        if let Some(outcome) = setting.over(incumbent, incumbent.report.expansions) {
            return Ok(outcome);
        }
    }
}
