//! Two threads: one search each, the caller's thread collects plans and watches the limits.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use crate::attachment::AttachmentError;
use crate::epoch::search::{Found, Statistics, Status};
use crate::outcome::Outcome;
use crate::schedule::{Limits, Optimiser};
use crate::solve::SolveError;
use crate::task::OperatorId;

use super::incumbent::Incumbent;
use super::{Setting, from_schedule};

/// When the other space is exhausted without a plan, the list-schedule search goes on for this
/// many times as long as that took, but at least for [`LEAST_GRACE`].
const GRACE: f64 = 8.0;
const LEAST_GRACE: Duration = Duration::from_millis(500);

/// How long the collecting thread sleeps at most.
const PAUSE: Duration = Duration::from_millis(5);

enum Message {
    Plan(Found),
    Schedule(Found),
    EpochProgress(Statistics),
    Lists(u64),
    EpochEnded {
        status: Status,
        chose_duration: bool,
    },
    ListsEnded,
    Failed(AttachmentError),
}

struct Shared {
    stop: AtomicBool,
    /// Bits of the makespan to beat.
    bound: AtomicU64,
}

/// Runs until an outcome is reached.
///
/// # Errors
/// A fault of an attachment.
pub(super) fn run(
    setting: &Setting<'_>,
    optimiser: Optimiser<'_>,
    warm: &[OperatorId],
    incumbent: &mut Incumbent<'_>,
) -> Result<Outcome, SolveError> {
    let shared = Shared {
        stop: AtomicBool::new(false),
        bound: AtomicU64::new(f64::INFINITY.to_bits()),
    };
    let (sender, receiver) = channel();
    let outcome = std::thread::scope(|scope| {
        let to_collector = sender.clone();
        let shared = &shared;
        scope.spawn(move || epoch_thread(setting, shared, &to_collector));
        scope.spawn(move || list_thread(optimiser, warm, shared, &sender));
        let outcome = collect(setting, shared, &receiver, incumbent);
        shared.stop.store(true, Ordering::Relaxed);
        outcome
    });
    // What the threads had done when they stopped.
    for message in receiver.try_iter() {
        match message {
            Message::Lists(nodes) => incumbent.report.schedules = nodes,
            Message::EpochProgress(statistics) => {
                incumbent.report.expansions = statistics.expansions;
                incumbent.report.evaluations = statistics.evaluations;
            }
            _ => {}
        }
    }
    outcome
}

fn epoch_thread(setting: &Setting<'_>, shared: &Shared, sender: &Sender<Message>) {
    let calls = setting.calls();
    let mut search = setting.search(&calls, setting.options.seed);
    loop {
        search.set_bound(f64::from_bits(shared.bound.load(Ordering::Relaxed)));
        let status = search.run(
            2_048,
            &mut || shared.stop.load(Ordering::Relaxed),
            &mut |found| drop(sender.send(Message::Plan(found))),
        );
        if let Some(error) = calls.failure() {
            drop(sender.send(Message::Failed(error)));
            return;
        }
        drop(sender.send(Message::EpochProgress(search.statistics)));
        if matches!(status, Status::Exhausted | Status::MemoryFull) {
            drop(sender.send(Message::EpochEnded {
                status,
                chose_duration: search.chose_duration,
            }));
            return;
        }
        if shared.stop.load(Ordering::Relaxed) {
            return;
        }
    }
}

fn list_thread(
    mut optimiser: Optimiser<'_>,
    warm: &[OperatorId],
    shared: &Shared,
    sender: &Sender<Message>,
) {
    let limits = Limits {
        deadline: None,
        patience: None,
        cancel: &shared.stop,
        nodes: None,
    };
    optimiser.run(
        (!warm.is_empty()).then_some(warm),
        &limits,
        &mut |schedule| drop(sender.send(Message::Schedule(from_schedule(schedule)))),
    );
    drop(sender.send(Message::Lists(optimiser.nodes())));
    drop(sender.send(Message::ListsEnded));
}

fn collect(
    setting: &Setting<'_>,
    shared: &Shared,
    receiver: &Receiver<Message>,
    incumbent: &mut Incumbent<'_>,
) -> Result<Outcome, SolveError> {
    let (mut epoch_open, mut lists_open) = (true, true);
    let mut last = Outcome::Exhausted;
    // When to stop if there is still no plan.
    let mut hopeless: Option<Instant> = None;
    let calls = setting.calls();
    let transitions = setting.transitions(&calls);
    loop {
        match receiver.recv_timeout(PAUSE) {
            Ok(Message::Plan(found)) => {
                incumbent.offer(&found);
                shared
                    .bound
                    .store(incumbent.bound().to_bits(), Ordering::Relaxed);
            }
            Ok(Message::Schedule(found)) => {
                incumbent.offer_checked(&transitions, &found);
                shared
                    .bound
                    .store(incumbent.bound().to_bits(), Ordering::Relaxed);
            }
            Ok(Message::EpochProgress(statistics)) => {
                incumbent.report.expansions = statistics.expansions;
                incumbent.report.evaluations = statistics.evaluations;
            }
            Ok(Message::Lists(nodes)) => incumbent.report.schedules = nodes,
            Ok(Message::EpochEnded {
                status,
                chose_duration,
            }) => {
                epoch_open = false;
                let grace = setting.begun.elapsed().mul_f64(GRACE).max(LEAST_GRACE);
                hopeless = Some(Instant::now() + grace);
                last = if status == Status::MemoryFull {
                    Outcome::OutOfMemory
                } else {
                    setting.exhausted_with(incumbent, chose_duration)
                };
                if matches!(last, Outcome::SolvedOptimally | Outcome::ProvenUnsolvable) {
                    return Ok(last);
                }
            }
            Ok(Message::ListsEnded) => lists_open = false,
            Ok(Message::Failed(error)) => return Err(error.into()),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(last),
        }
        let given_up = hopeless.is_some_and(|until| Instant::now() >= until);
        if (!epoch_open && !lists_open) || (given_up && !incumbent.exists()) {
            return Ok(last);
        }
        if let Some(outcome) = setting.over(incumbent, incumbent.report.expansions) {
            return Ok(outcome);
        }
    }
}
