//! From state to state: starting operators and letting time pass.

use crate::plan::EPSILON;
use crate::task::{Duration, OperatorId};

use super::calls::Calls;
use super::compiled::{Compiled, Condition, Happening, comparison_holds, evaluate, too_close};
use super::state::{Event, Running, State};

/// Starts operators and lets time pass.
#[derive(Clone, Copy)]
pub struct Transitions<'a> {
    /// The task.
    pub compiled: &'a Compiled<'a>,
    /// State-dependent attachments.
    pub calls: &'a Calls<'a>,
}

impl<'a> Transitions<'a> {
    /// The state at time 0.
    #[must_use]
    pub fn initial(&self) -> State {
        let mut state = State::initial(self.compiled);
        self.derive(&mut state);
        state
    }

    /// Whether a condition holds in a state.
    #[must_use]
    pub fn holds(
        &self,
        condition: &Condition,
        state: &State,
        duration: f64,
        operator: Option<OperatorId>,
    ) -> bool {
        if !condition.literals_hold(&state.facts) {
            return false;
        }
        if condition.comparisons.is_empty() && condition.calls.is_empty() {
            return true;
        }
        let name = || self.name(operator);
        let snapshot = state.snapshot();
        condition.comparisons.iter().all(|comparison| {
            comparison_holds(comparison, &state.values, duration, &mut |call| {
                self.calls.value(call, snapshot, &name)
            })
        }) && condition
            .calls
            .iter()
            .all(|&(call, wanted)| self.calls.holds(call, snapshot, &name) == wanted)
    }

    pub(super) fn name(&self, operator: Option<OperatorId>) -> String {
        operator.map_or_else(
            || "the goal".into(),
            |operator| self.compiled.task.operator_name(operator),
        )
    }

    /// Whether nothing runs and the goal holds once all timed literals to come have happened; they
    /// do not lengthen a plan.
    #[must_use]
    pub fn is_goal(&self, state: &State) -> bool {
        if !state.running.is_empty() {
            return false;
        }
        if (state.next_timed as usize) < self.compiled.task.timed.len() {
            let mut later = state.clone();
            while (later.next_timed as usize) < self.compiled.task.timed.len() {
                if !self.advance(&mut later) {
                    return false;
                }
            }
            return self.holds(&self.compiled.goal, &later, 0.0, None);
        }
        self.holds(&self.compiled.goal, state, 0.0, None)
    }

    /// The value of the metric in a final state; `None` if the makespan is minimised.
    #[must_use]
    pub fn metric(&self, state: &State, makespan: f64) -> Option<f64> {
        let metric = self.compiled.task.metric.as_ref()?;
        let mut last = state.clone();
        while (last.next_timed as usize) < self.compiled.task.timed.len() && self.advance(&mut last)
        {
        }
        let snapshot = last.snapshot();
        Some(evaluate(
            &metric.expression,
            &last.values,
            f64::NAN,
            makespan,
            &mut |call| self.calls.value(call, snapshot, &|| "the metric".into()),
        ))
    }

    /// The duration that an operator gets when started in a state; `longest` asks for the upper
    /// bound. NaN if it has none.
    #[must_use]
    pub fn duration(&self, operator: OperatorId, state: &State, longest: bool) -> f64 {
        match &self.compiled.operator(operator).duration {
            None => 0.0,
            Some(Duration::Fixed(value)) => *value,
            Some(Duration::Bounds(lower, upper)) => {
                let name = || self.name(Some(operator));
                let snapshot = state.snapshot();
                let mut call = |id| self.calls.value(id, snapshot, &name);
                let lower = evaluate(lower, &state.values, f64::NAN, 0.0, &mut call).max(0.0);
                let upper = evaluate(upper, &state.values, f64::NAN, 0.0, &mut call);
                if lower.is_nan() || upper.is_nan() || lower > upper {
                    f64::NAN
                } else if longest {
                    upper
                } else {
                    lower
                }
            }
        }
    }

    /// Starts an operator in place, now or as few epsilons later as interference allows; false,
    /// leaving the state unspecified, if it cannot start before the next event.
    pub fn start(&self, state: &mut State, id: OperatorId, longest: bool) -> bool {
        self.start_lasting(state, id, self.duration(id, state, longest))
    }

    /// Runs steps (operator, start, duration) at just the times given, sorted by start; the state in
    /// which all have ended, or `None` if they are no valid plan up to there.
    #[must_use]
    pub fn execute(&self, steps: &[(OperatorId, f64, Option<f64>)]) -> Option<State> {
        let mut state = self.initial();
        for &(operator, start, duration) in steps {
            while state
                .next_event(self.compiled)
                .is_some_and(|next| next <= start)
            {
                if !self.advance(&mut state) {
                    return None;
                }
            }
            let [least, most] =
                [false, true].map(|longest| self.duration(operator, &state, longest));
            let duration = duration.unwrap_or(0.0);
            if duration < least - 1e-9 || duration > most + 1e-9 {
                return None;
            }
            self.move_to(&mut state, start);
            if !self.start_lasting(&mut state, operator, duration)
                || (state.time - start).abs() > EPSILON * 1e-3
            {
                return None;
            }
        }
        while !state.running.is_empty() {
            if !self.advance(&mut state) {
                return None;
            }
        }
        Some(state)
    }

    /// Lets time pass until nothing runs; false, leaving the state unspecified, if something fails.
    pub fn finish(&self, state: &mut State) -> bool {
        while !state.running.is_empty() {
            if !self.advance(state) {
                return false;
            }
        }
        true
    }

    /// Starts an operator with a given duration.
    fn start_lasting(&self, state: &mut State, id: OperatorId, duration: f64) -> bool {
        let operator = self.compiled.operator(id);
        if !duration.is_finite() || duration < 0.0 {
            return false;
        }
        if !self.holds(&operator.start_condition, state, duration, Some(id)) {
            return false;
        }
        let Some(time) = self.start_time(state, operator, duration) else {
            return false;
        };
        if self.doomed(state, operator, time + duration) {
            return false;
        }
        self.move_to(state, time);
        let conditional = self.remembered(operator, state, duration, id);
        if !self.apply(state, &operator.start, duration, u32::MAX, id) {
            return false;
        }
        state.recent.push((time, Event::Start(id)));
        self.derive(state);
        if operator.duration.is_some() {
            let running = Running {
                end: time + duration,
                start: time,
                operator: id,
                conditional,
            };
            let position = state
                .running
                .partition_point(|other| (other.end, other.operator) <= (running.end, id));
            state.running.insert(position, running);
        }
        self.invariants_hold(state)
    }

    /// What an event reads and writes.
    #[must_use]
    pub fn happening(&self, event: Event) -> &'a Happening {
        match event {
            Event::Start(operator) => &self.compiled.operator(operator).start,
            Event::End(operator) => &self.compiled.operator(operator).end,
            Event::Timed(index) => &self.compiled.timed[index as usize],
        }
    }

    pub(super) fn move_to(&self, state: &mut State, time: f64) {
        state.time = state.time.max(time);
        let now = state.time;
        state.recent.retain(|(at, _)| too_close(*at, now));
    }

    /// Lets time pass to the next event; false, leaving the state unspecified, if a condition at
    /// the end of an action fails or an invariant breaks, or if nothing is left to happen.
    pub fn advance(&self, state: &mut State) -> bool {
        let Some(time) = state.next_event(self.compiled) else {
            return false;
        };
        self.move_to(state, time);
        let ending: Vec<Running> = state
            .running
            .iter()
            .take_while(|running| running.end <= time)
            .copied()
            .collect();
        state.running.drain(..ending.len());
        for running in &ending {
            let operator = self.compiled.operator(running.operator);
            let duration = running.end - running.start;
            if !self.holds(
                &operator.end_condition,
                state,
                duration,
                Some(running.operator),
            ) {
                return false;
            }
        }
        let before = (ending.len() > 1).then(|| state.clone());
        for running in &ending {
            let operator = self.compiled.operator(running.operator);
            let duration = running.end - running.start;
            let view = before.as_ref();
            if !self.apply_seen_from(
                view,
                state,
                &operator.end,
                duration,
                running.conditional,
                running.operator,
            ) {
                return false;
            }
            state.recent.push((time, Event::End(running.operator)));
        }
        while let Some(event) = self.compiled.task.timed.get(state.next_timed as usize) {
            if event.time > time {
                break;
            }
            let happening = &self.compiled.timed[state.next_timed as usize];
            if !self.apply(state, happening, 0.0, u32::MAX, OperatorId(u32::MAX)) {
                return false;
            }
            state.recent.push((time, Event::Timed(state.next_timed)));
            state.next_timed += 1;
        }
        self.derive(state);
        self.invariants_hold(state)
    }
}
