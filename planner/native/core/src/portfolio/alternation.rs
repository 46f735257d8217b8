//! One thread: the searches take turns, each turn longer than the last.

use std::cell::OnceCell;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use crate::epoch::search::Status;
use crate::outcome::Outcome;
use crate::schedule::{Ending, Limits, Optimiser};
use crate::solve::SolveError;

use super::incumbent::Incumbent;
use super::prelude::Prelude;
use super::{Role, Setting, from_schedule};

/// First turn of the list-schedule search.
const TURN: Duration = Duration::from_millis(40);
/// How long the first list may take.
const PATIENCE: Duration = Duration::from_secs(2);
/// A turn in nodes, where those are limited and the clock must not matter.
const TURN_NODES: u64 = 400;
/// Part of a turn that the decision-epoch search gets once there is a plan.
const SHARE: f64 = 0.15;

/// Parts of a turn that each search for sequential plans gets; only a task without a plan does.
const PRELUDE_SHARE: f64 = 1.5;
/// From which turns on there are more of them, led by something else.
const MORE_PRELUDES: [u32; 2] = [1, 3];

/// Turns in which it gets more: small spaces are exhausted, and proofs found, by then.
const EARLY: u32 = 4;

/// Turns that the list-schedule search gets without a plan when the other space is exhausted.
const LAST_TURNS: u32 = 4;

static NEVER: AtomicBool = AtomicBool::new(false);

/// Runs until an outcome is reached.
///
/// # Errors
/// A fault of an attachment.
pub(super) fn run(
    setting: &Setting<'_>,
    optimiser: Option<Optimiser<'_>>,
    warm: &[crate::task::OperatorId],
    incumbent: &mut Incumbent<'_>,
) -> Result<Outcome, SolveError> {
    let calls = setting.calls();
    let transitions = setting.transitions(&calls);
    let mut search = setting.search(&calls, setting.options.seed);
    let (compressed, tables) = (OnceCell::new(), OnceCell::new());
    let mut preludes = Prelude::all(setting.options);
    if !setting.affords_sequences() {
        preludes.clear();
    }
    if setting.role == Role::Second && !preludes.is_empty() {
        // Begins with what the first thread comes to last.
        preludes.rotate_right(1);
    }
    let mut optimiser = optimiser;
    let mut epoch_open = true;
    // How the decision-epoch search ended.
    let mut epoch_ended = Outcome::Exhausted;
    let mut turn = 0_u32;
    let mut turns_alone = 0_u32;
    // Expansions of the search for sequential plans.
    let mut sequential = 0_u64;
    // What is in force already has been repaired.
    let repaired = incumbent.exists();
    let mut adopt: Vec<_> = if repaired { Vec::new() } else { warm.to_vec() };
    // Where one action has to start inside another, the list-schedule search is the second choice.
    let epoch_first = setting.completeness.required_concurrency;
    let outcome = (|| loop {
        if incumbent.import() {
            adopt = incumbent.operators().to_vec();
        }
        let growth = f64::from(turn.min(24)).exp2();
        // Threads that share their plans look at those of the others now and then.
        let longest = if setting.role == Role::Alone {
            512.0
        } else {
            64.0
        };
        let turn_time = TURN.mul_f64(growth.min(longest));
        let turn_nodes = (TURN_NODES as f64 * growth) as u64;
        if let Some(list_search) = &mut optimiser
            && !(epoch_first && turn == 0 && warm.is_empty())
        {
            let spent = list_search.nodes() + search.statistics.expansions + sequential;
            let nodes = setting
                .options
                .node_limit
                .map(|limit| turn_nodes.min(limit.saturating_sub(spent)));
            let mut until = setting.deadline();
            let mut patience = None;
            if setting.options.node_limit.is_none() {
                let turn_end = Instant::now() + turn_time;
                let late = Instant::now() + PATIENCE;
                patience = Some(until.map_or(late, |deadline| deadline.min(late)));
                until = Some(until.map_or(turn_end, |deadline| deadline.min(turn_end)));
            }
            let first_only = setting.options.first_plan_only;
            let enough = AtomicBool::new(false);
            let limits = Limits {
                deadline: until,
                patience,
                cancel: if first_only {
                    &enough
                } else {
                    setting.options.cancel.unwrap_or(&NEVER)
                },
                nodes,
            };
            let from = (!adopt.is_empty()).then_some(adopt.as_slice());
            let mut sound = true;
            let ending = list_search.run(from, &limits, &mut |schedule| {
                sound &= incumbent.offer_checked(&transitions, &from_schedule(schedule));
                enough.store(true, std::sync::atomic::Ordering::Relaxed);
            });
            adopt.clear();
            incumbent.report.schedules = list_search.nodes();
            if ending != Ending::Limit || !sound {
                optimiser = None;
            }
        }
        if let Some(outcome) = setting.over(incumbent, search.statistics.expansions) {
            break Ok(outcome);
        }
        let settled = setting.promptness.is_some() && optimiser.is_some() && incumbent.exists();
        if epoch_open && !settled {
            let alone = optimiser.is_none();
            let share = match (alone, incumbent.exists()) {
                (true, _) => 4.0,
                (false, true) if turn < EARLY => 0.5,
                (false, true) => SHARE,
                (false, false) if preludes.iter().all(Prelude::ended) => 1.0,
                (false, false) => 0.5,
            };
            let end = Instant::now() + turn_time.mul_f64(share);
            let timed = setting.options.node_limit.is_none();
            let mut budget = ((turn_nodes as f64 * share) as u64).max(16);
            let spent = incumbent.report.schedules + search.statistics.expansions + sequential;
            budget = budget.min(setting.nodes_left(spent));
            search.set_bound(incumbent.bound());
            if incumbent.exists() {
                // They have found what they were for; gives the memory back.
                preludes.clear();
            }
            let only_search = preludes.iter().all(Prelude::ended);
            let memory = setting.memory();
            search.parameters.memory = if only_search { memory } else { memory / 2 };
            loop {
                let before = search.statistics.expansions;
                let mut best_operators = None;
                let status = search.run(
                    if timed { u64::MAX >> 1 } else { budget },
                    &mut || (timed && Instant::now() >= end) || setting.interrupted().is_some(),
                    &mut |found| {
                        if incumbent.offer(&found) {
                            best_operators = Some(incumbent.operators().to_vec());
                        }
                    },
                );
                budget = budget.saturating_sub(search.statistics.expansions - before);
                incumbent.report.expansions = search.statistics.expansions;
                incumbent.report.evaluations = search.statistics.evaluations;
                if let Some(operators) = best_operators {
                    adopt = operators;
                }
                if let Some(error) = calls.failure() {
                    return Err(error.into());
                }
                match status {
                    Status::Exhausted => {
                        let outcome = setting.exhausted(incumbent, &search);
                        let settled = matches!(
                            outcome,
                            Outcome::SolvedOptimally | Outcome::ProvenUnsolvable
                        );
                        if settled || optimiser.is_none() {
                            return Ok(outcome);
                        }
                        epoch_ended = outcome;
                        epoch_open = false;
                    }
                    Status::MemoryFull => {
                        if optimiser.is_none() {
                            return Ok(Outcome::OutOfMemory);
                        }
                        epoch_ended = Outcome::OutOfMemory;
                        epoch_open = false;
                        // Gives the memory back.
                        search = setting.search(&calls, setting.options.seed);
                    }
                    Status::Found
                        if !incumbent.is_optimal() && !setting.options.first_plan_only =>
                    {
                        search.set_bound(incumbent.bound());
                        let time_left = timed && Instant::now() < end;
                        if time_left || (!timed && budget > 0) {
                            continue;
                        }
                    }
                    Status::Found | Status::Interrupted => {}
                }
                break;
            }
        } else {
            turns_alone += 1;
            let hopeless = !incumbent.exists() && turns_alone >= LAST_TURNS;
            if optimiser.is_none() || hopeless {
                return Ok(epoch_ended);
            }
        }
        let begun = 1 + MORE_PRELUDES.iter().filter(|from| turn >= **from).count();
        for prelude in preludes.iter_mut().take(begun) {
            if incumbent.exists() {
                break;
            }
            let end = Instant::now() + turn_time.mul_f64(PRELUDE_SHARE);
            let timed = setting.options.node_limit.is_none();
            let before = prelude.statistics();
            let spent = incumbent.report.schedules + search.statistics.expansions + sequential;
            let found = prelude.run(
                setting,
                &compressed,
                &tables,
                if timed {
                    u64::MAX >> 1
                } else {
                    turn_nodes.min(setting.nodes_left(spent))
                },
                &mut || (timed && Instant::now() >= end) || setting.interrupted().is_some(),
            );
            let spent = prelude.statistics();
            sequential += spent.expansions - before.expansions;
            incumbent.report.evaluations += spent.evaluations - before.evaluations;
            if let Some(found) = found
                && incumbent.offer(&found)
            {
                adopt = incumbent.operators().to_vec();
            }
        }
        if let Some(outcome) = setting.over(incumbent, search.statistics.expansions + sequential) {
            break Ok(outcome);
        }
        turn += 1;
    })();
    if let Ok(outcome) = outcome
        && setting.role == Role::Alone
    {
        // Before the tables are given back.
        setting.tell_stopped(incumbent, outcome);
    }
    outcome
}
