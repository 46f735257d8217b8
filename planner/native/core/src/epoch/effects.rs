//! Effects of happenings, conditions that running operators keep watching.

use crate::pddl::model::Assignment;
use crate::task::{Change, OperatorId};

use super::compiled::{CompiledOperator, Effect, Happening, evaluate};
use super::state::State;
use super::transitions::Transitions;

impl Transitions<'_> {
    pub(super) fn remembered(
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

    pub(super) fn invariants_hold(&self, state: &mut State) -> bool {
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

    pub(super) fn apply(
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
    pub(super) fn apply_seen_from(
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
