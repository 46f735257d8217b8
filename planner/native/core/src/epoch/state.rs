//! Time-stamped states: starting operators and letting time pass.

use crate::pddl::model::Assignment;
use crate::plan::EPSILON;
use crate::task::{Change, Duration, FactId, OperatorId};

use super::calls::{Calls, Snapshot};
use super::compiled::{
    Compiled, CompiledOperator, Condition, Effect, Happening, comparison_holds, evaluate, too_close,
};

/// How often a start is put off by [`EPSILON`] to keep clear of interfering happenings.
const SHIFTS: usize = 32;

/// An operator that has started and not yet ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Running {
    /// When it ends [s].
    pub end: f64,
    /// When it started [s].
    pub start: f64,
    /// Which it is.
    pub operator: OperatorId,
    /// Bit `i` is set while the start and over-all conditions of its `i`-th end effect have held.
    pub conditional: u32,
}

/// One of the happenings of the last [`EPSILON`] seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// An operator started.
    Start(OperatorId),
    /// An operator ended.
    End(OperatorId),
    /// A timed initial literal, by position.
    Timed(u32),
}

/// A state of the decision-epoch space.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// Now [s].
    pub time: f64,
    /// Facts that hold, one bit each.
    pub facts: Vec<u64>,
    /// Values of the fluents.
    pub values: Vec<f64>,
    /// Running operators in the order of their ends, then ids.
    pub running: Vec<Running>,
    /// The next timed initial literal.
    pub next_timed: u32,
    /// What happened within the last [`EPSILON`] seconds, with its time.
    pub recent: Vec<(f64, Event)>,
}

impl State {
    /// The state at time 0.
    #[must_use]
    pub fn initial(compiled: &Compiled<'_>) -> Self {
        let mut state = Self {
            facts: vec![0; compiled.words],
            values: compiled.task.initial_values.clone(),
            ..Self::default()
        };
        for &fact in &compiled.task.initial_facts {
            state.set(fact, true);
        }
        state.derive(compiled);
        state
    }

    /// Whether a fact holds.
    #[inline]
    #[must_use]
    pub fn holds(&self, fact: FactId) -> bool {
        self.facts[fact.index() / 64] & (1 << (fact.index() % 64)) != 0
    }

    fn set(&mut self, fact: FactId, value: bool) {
        let bit = 1 << (fact.index() % 64);
        if value {
            self.facts[fact.index() / 64] |= bit;
        } else {
            self.facts[fact.index() / 64] &= !bit;
        }
    }

    /// What attachments may look at.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<'_> {
        Snapshot {
            facts: &self.facts,
            values: &self.values,
        }
    }

    /// When something happens by itself, if anything still does.
    #[must_use]
    pub fn next_event(&self, compiled: &Compiled<'_>) -> Option<f64> {
        let timed = compiled
            .task
            .timed
            .get(self.next_timed as usize)
            .map(|event| event.time);
        let end = self.running.first().map(|running| running.end);
        match (timed, end) {
            (Some(timed), Some(end)) => Some(timed.min(end)),
            (timed, end) => timed.or(end),
        }
    }

    /// The time at which everything now running has ended [s]; minus infinity if nothing runs.
    #[must_use]
    pub fn last_end(&self) -> f64 {
        self.running
            .last()
            .map_or(f64::NEG_INFINITY, |running| running.end)
    }
}

/// Starts operators and lets time pass.
#[derive(Clone, Copy)]
pub struct Transitions<'a> {
    /// The task.
    pub compiled: &'a Compiled<'a>,
    /// State-dependent attachments.
    pub calls: &'a Calls<'a>,
}

impl<'a> Transitions<'a> {
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

    fn name(&self, operator: Option<OperatorId>) -> String {
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
        let mut state = State::initial(self.compiled);
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
        state.derive(self.compiled);
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

    /// Whether, of the new operator and those running, the end of one falls into another that it
    /// certainly breaks.
    fn doomed(&self, state: &State, operator: &CompiledOperator, end: f64) -> bool {
        state.running.iter().any(|running| {
            let other = self.compiled.operator(running.operator);
            (running.end < end && operator.broken_by_end_of(other))
                || (end < running.end && other.broken_by_end_of(operator))
        })
    }

    /// The earliest start that keeps clear of what happened and of what will.
    fn start_time(&self, state: &State, operator: &CompiledOperator, duration: f64) -> Option<f64> {
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

    /// What an event reads and writes.
    #[must_use]
    pub fn happening(&self, event: Event) -> &'a Happening {
        match event {
            Event::Start(operator) => &self.compiled.operator(operator).start,
            Event::End(operator) => &self.compiled.operator(operator).end,
            Event::Timed(index) => &self.compiled.timed[index as usize],
        }
    }

    fn move_to(&self, state: &mut State, time: f64) {
        state.time = state.time.max(time);
        let now = state.time;
        state.recent.retain(|(at, _)| too_close(*at, now));
    }

    fn remembered(
        &self,
        operator: &CompiledOperator,
        state: &State,
        duration: f64,
        id: OperatorId,
    ) -> u32 {
        if !operator.remembers {
            return u32::MAX;
        }
        let mut bits = u32::MAX;
        for (index, effect) in operator.end.effects.iter().enumerate().take(32) {
            if let Some(conditions) = &effect.condition
                && !self.holds(&conditions[0], state, duration, Some(id))
            {
                bits &= !(1 << index);
            }
        }
        bits
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
        state.derive(self.compiled);
        self.invariants_hold(state)
    }

    fn invariants_hold(&self, state: &mut State) -> bool {
        for index in 0..state.running.len() {
            let running = state.running[index];
            let operator = self.compiled.operator(running.operator);
            let duration = running.end - running.start;
            if !operator.invariant.is_empty()
                && !self.holds(&operator.invariant, state, duration, Some(running.operator))
            {
                return false;
            }
            if operator.remembers {
                for (bit, effect) in operator.end.effects.iter().enumerate().take(32) {
                    if let Some(conditions) = &effect.condition
                        && !self.holds(&conditions[1], state, duration, Some(running.operator))
                    {
                        state.running[index].conditional &= !(1 << bit);
                    }
                }
            }
        }
        true
    }

    fn apply(
        &self,
        state: &mut State,
        happening: &Happening,
        duration: f64,
        conditional: u32,
        operator: OperatorId,
    ) -> bool {
        self.apply_seen_from(None, state, happening, duration, conditional, operator)
    }

    /// Applies the effects of a happening, whose conditions and right-hand sides are evaluated in
    /// `view`, or in the state before if there is none; false if a value is undefined.
    fn apply_seen_from(
        &self,
        view: Option<&State>,
        state: &mut State,
        happening: &Happening,
        duration: f64,
        conditional: u32,
        id: OperatorId,
    ) -> bool {
        let simple = |effect: &Effect| {
            effect.condition.is_none()
                && matches!(effect.change, Change::Add(_) | Change::Delete(_))
        };
        if happening.effects.iter().all(simple) {
            for effect in &happening.effects {
                match effect.change {
                    Change::Add(fact) => state.set(fact, true),
                    Change::Delete(fact) => state.set(fact, false),
                    Change::Assign(..) | Change::Call(_) => {}
                }
            }
            return true;
        }
        let copy;
        let view = match view {
            Some(view) => view,
            None => {
                copy = state.clone();
                &copy
            }
        };
        let operator = (id.0 != u32::MAX).then_some(id);
        let mut written: Vec<(u32, bool)> = Vec::new();
        for (index, effect) in happening.effects.iter().enumerate() {
            if let Some(conditions) = &effect.condition {
                let remembered = index >= 32 || conditional & (1 << index) != 0;
                let is_start = operator
                    .is_some_and(|o| std::ptr::eq(happening, &self.compiled.operator(o).start));
                let first = !is_start || self.holds(&conditions[0], view, duration, operator);
                if !remembered || !first || !self.holds(&conditions[2], view, duration, operator) {
                    continue;
                }
            }
            match &effect.change {
                Change::Add(fact) => state.set(*fact, true),
                Change::Delete(fact) => state.set(*fact, false),
                Change::Assign(assignment, fluent, expression) => {
                    // One happening may not give a fluent two values; changes by amounts add up.
                    let additive =
                        matches!(assignment, Assignment::Increase | Assignment::Decrease);
                    if written
                        .iter()
                        .any(|w| w.0 == fluent.0 && !(w.1 && additive))
                    {
                        return false;
                    }
                    written.push((fluent.0, additive));
                    let name = || self.name(operator);
                    let snapshot = view.snapshot();
                    let value =
                        evaluate(expression, &view.values, duration, view.time, &mut |call| {
                            self.calls.value(call, snapshot, &name)
                        });
                    let old = state.values[fluent.index()];
                    let new = match assignment {
                        Assignment::Assign => value,
                        Assignment::Increase => old + value,
                        Assignment::Decrease => old - value,
                        Assignment::ScaleUp => old * value,
                        Assignment::ScaleDown => old / value,
                    };
                    if !new.is_finite() {
                        return false;
                    }
                    state.values[fluent.index()] = new;
                }
                Change::Call(call) => {
                    let name = || self.name(operator);
                    if let Some(values) = self.calls.change(*call, view.snapshot(), &name) {
                        let writes = &self.compiled.task.calls[call.index()].writes;
                        for (fluent, value) in writes.iter().zip(values) {
                            state.values[fluent.index()] = value;
                        }
                    }
                    if self.calls.failure().is_some() {
                        return false;
                    }
                }
            }
        }
        true
    }
}

enum Clash {
    Start,
    End(f64),
}

impl State {
    /// Recomputes the derived facts, stratum by stratum, to the least fixpoint.
    fn derive(&mut self, compiled: &Compiled<'_>) {
        if compiled.axioms.is_empty() {
            return;
        }
        for &fact in &compiled.derived {
            self.set(fact, false);
        }
        let mut from = 0;
        while from < compiled.axioms.len() {
            let stratum = compiled.axioms[from].0;
            let to = from + compiled.axioms[from..].partition_point(|axiom| axiom.0 == stratum);
            let mut changed = true;
            while changed {
                changed = false;
                for (_, condition, head) in &compiled.axioms[from..to] {
                    if !self.holds(*head)
                        && condition.literals_hold(&self.facts)
                        && condition.comparisons.iter().all(|comparison| {
                            comparison_holds(comparison, &self.values, 0.0, &mut |_| f64::NAN)
                        })
                    {
                        self.set(*head, true);
                        changed = true;
                    }
                }
            }
            from = to;
        }
    }
}
