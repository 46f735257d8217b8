//! Keeping happenings that interfere [`EPSILON`] apart.

use crate::plan::EPSILON;

use super::compiled::{CompiledOperator, Happening, too_close};
use super::state::State;
use super::transitions::Transitions;

/// How often a start is put off by [`EPSILON`] to keep clear of interfering happenings.
const SHIFTS: usize = 32;

enum Clash {
    Start,
    End(f64),
}

impl Transitions<'_> {
    /// Whether, of the new operator and those running, the end of one falls into another that it
    /// certainly breaks.
    pub(super) fn doomed(&self, state: &State, operator: &CompiledOperator, end: f64) -> bool {
        state.running.iter().any(|running| {
            let other = self.compiled.operator(running.operator);
            (running.end < end && operator.broken_by_end_of(other))
                || (end < running.end && other.broken_by_end_of(operator))
        })
    }

    /// The earliest start that keeps clear of what happened and of what will.
    pub(super) fn start_time(
        &self,
        state: &State,
        operator: &CompiledOperator,
        duration: f64,
    ) -> Option<f64> {
        let mut time = state.time;
        for &(happened, event) in &state.recent {
            if happened + EPSILON > time && self.happening(event).interferes(&operator.start) {
                time = happened + EPSILON;
            }
        }
        let next = self.next_events(state, time, operator.duration.is_some().then_some(duration));
        let first = state.next_event(self.compiled).unwrap_or(f64::INFINITY);
        for _ in 0..SHIFTS {
            if time > first {
                return None;
            }
            let end = time + duration;
            let clash = next(time, end, operator);
            match clash {
                None => return Some(time),
                Some(Clash::Start) => return None,
                Some(Clash::End(other)) => {
                    // Behind the happening that the end is too close to.
                    time += (other + EPSILON - end).max(EPSILON * 1e-3);
                }
            }
        }
        None
    }

    fn next_events<'s>(
        &'s self,
        state: &'s State,
        _time: f64,
        duration: Option<f64>,
    ) -> impl Fn(f64, f64, &CompiledOperator) -> Option<Clash> + 's {
        move |start, end, operator| {
            let check = |at: f64, happening: &Happening| {
                if too_close(at, start) && happening.interferes(&operator.start) {
                    return Some(Clash::Start);
                }
                if duration.is_some() && too_close(at, end) && happening.interferes(&operator.end) {
                    return Some(Clash::End(at));
                }
                None
            };
            if duration.is_some_and(|d| d < EPSILON) && operator.start.interferes(&operator.end) {
                return Some(Clash::Start);
            }
            for running in &state.running {
                let happening = &self.compiled.operator(running.operator).end;
                if let Some(clash) = check(running.end, happening) {
                    return Some(clash);
                }
            }
            for (index, event) in self
                .compiled
                .task
                .timed
                .iter()
                .enumerate()
                .skip(state.next_timed as usize)
            {
                if event.time > end + EPSILON {
                    break;
                }
                if let Some(clash) = check(event.time, &self.compiled.timed[index]) {
                    return Some(clash);
                }
            }
            None
        }
    }
}
