//! A list schedule under construction: every fact and fluent knows when it was last changed and
//! read, every operator is dispatched at its earliest start, every step can be undone.
//!
//! Soundness: the happenings that touch one fact (or fluent) happen in the order of the list and
//! interfering ones are [`EPSILON`](super::model::EPSILON) apart, so each operator reads in time what it read in the
//! list; operators further down the list may nevertheless start earlier.

use crate::pddl::model::Assignment;
use crate::schedule::model::{Comparing, Model, NONE};
use crate::task::{Change, GroundExpression, Task};

const BEFORE: f64 = -1.0;
const NEVER: f64 = f64::NEG_INFINITY;

/// A fact's value and its time stamps [s].
#[derive(Clone, Copy, Debug)]
pub struct FactStamp {
    /// When it last got a different value.
    pub since: f64,
    /// When it was last written, redundant writes included.
    pub changed: f64,
    /// When a happening last read it.
    pub read: f64,
    /// Until when it has to keep its value.
    pub hold: f64,
    pub value: bool,
}

/// A fluent's value and its time stamps [s].
#[derive(Clone, Copy, Debug)]
pub struct FluentStamp {
    pub value: f64,
    /// Last change of any kind.
    pub changed: f64,
    /// Last change that does not commute with others.
    pub assigned: f64,
    pub read: f64,
    pub hold: f64,
}

/// A past value that may still be read: from, until, value.
pub type Window = (f64, f64, bool);

/// One dispatched operator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dispatch {
    pub operator: u32,
    pub start: f64,
    pub duration: f64,
    /// When it could have started, if it waits for what happens while it runs [s].
    pub earliest: f64,
}

impl Dispatch {
    /// End [s].
    pub fn end(&self) -> f64 {
        self.start + self.duration
    }
}

/// A point to go back to.
#[derive(Clone, Copy, Debug)]
pub struct Mark {
    facts: usize,
    fluents: usize,
    windows: usize,
    list: usize,
    makespan: f64,
}

/// The schedule and the state after it.
#[derive(Clone, Debug)]
pub struct State {
    pub facts: Vec<FactStamp>,
    pub fluents: Vec<FluentStamp>,
    /// Bit set of the facts that hold.
    pub truth: Vec<u64>,
    pub list: Vec<Dispatch>,
    /// Where to return to before each dispatch of the list.
    marks: Vec<Mark>,
    pub makespan: f64,
    pub(super) windows: Vec<Vec<Window>>,
    fact_journal: Vec<(u32, FactStamp)>,
    fluent_journal: Vec<(u32, FluentStamp)>,
    pub(super) window_journal: Vec<u32>,
}

impl State {
    /// The empty schedule. Timed initial literals are applied at once: what they leave behind can
    /// be read after them, the values before them as windows.
    pub fn new(model: &Model, task: &Task) -> Self {
        let fact = |value| FactStamp {
            since: BEFORE,
            changed: BEFORE,
            read: NEVER,
            hold: NEVER,
            value,
        };
        let mut state = Self {
            facts: model
                .initial_facts
                .iter()
                .map(|value| fact(*value))
                .collect(),
            fluents: model
                .initial_values
                .iter()
                .map(|value| FluentStamp {
                    value: *value,
                    changed: BEFORE,
                    assigned: BEFORE,
                    read: NEVER,
                    hold: NEVER,
                })
                .collect(),
            truth: vec![0; model.fact_count.div_ceil(64)],
            list: Vec::new(),
            marks: Vec::new(),
            makespan: 0.0,
            windows: vec![Vec::new(); model.windowed.len()],
            fact_journal: Vec::new(),
            fluent_journal: Vec::new(),
            window_journal: Vec::new(),
        };
        for (index, stamp) in state.facts.iter().enumerate() {
            state.truth[index / 64] |= u64::from(stamp.value) << (index % 64);
        }
        for event in &task.timed {
            match &event.change {
                Change::Add(fact) => state.write(model, fact.0, true, event.time),
                Change::Delete(fact) => state.write(model, fact.0, false, event.time),
                Change::Assign(assignment, fluent, value) => {
                    let value = state.evaluate(value, 0.0, &[]);
                    state.assign(*assignment, fluent.0, value, event.time);
                }
                Change::Call(_) => {}
            }
        }
        state.fact_journal.clear();
        state.fluent_journal.clear();
        state.window_journal.clear();
        state
    }

    /// Where [`Self::rollback`] can return to.
    pub fn mark(&self) -> Mark {
        Mark {
            facts: self.fact_journal.len(),
            fluents: self.fluent_journal.len(),
            windows: self.window_journal.len(),
            list: self.list.len(),
            makespan: self.makespan,
        }
    }

    /// Undoes everything since the mark.
    pub fn rollback(&mut self, mark: Mark) {
        while self.fact_journal.len() > mark.facts {
            if let Some((fact, stamp)) = self.fact_journal.pop() {
                self.facts[fact as usize] = stamp;
                self.set_truth(fact, stamp.value);
            }
        }
        while self.fluent_journal.len() > mark.fluents {
            if let Some((fluent, stamp)) = self.fluent_journal.pop() {
                self.fluents[fluent as usize] = stamp;
            }
        }
        while self.window_journal.len() > mark.windows {
            if let Some(window) = self.window_journal.pop() {
                self.windows[window as usize].pop();
            }
        }
        self.list.truncate(mark.list);
        self.marks.truncate(mark.list);
        self.makespan = mark.makespan;
    }

    /// Undoes everything.
    pub fn reset(&mut self) {
        self.rollback(Mark {
            facts: 0,
            fluents: 0,
            windows: 0,
            list: 0,
            makespan: 0.0,
        });
    }

    /// Undoes what comes behind the common beginning of the list and these operators; its length.
    pub fn keep_beginning(&mut self, operators: impl Iterator<Item = u32>) -> usize {
        let common = self
            .list
            .iter()
            .zip(operators)
            .take_while(|(dispatch, operator)| dispatch.operator == *operator)
            .count();
        if let Some(mark) = self.marks.get(common) {
            self.rollback(*mark);
        }
        common
    }

    /// Notes a dispatch whose effects are to be applied.
    pub(super) fn push(&mut self, dispatch: Dispatch, before: Mark) {
        self.makespan = self.makespan.max(dispatch.end());
        self.list.push(dispatch);
        self.marks.push(before);
    }

    pub(super) fn set_truth(&mut self, fact: u32, value: bool) {
        let word = &mut self.truth[fact as usize / 64];
        let bit = 1 << (fact % 64);
        if value {
            *word |= bit;
        } else {
            *word &= !bit;
        }
    }

    /// Whether a literal holds at the end of the list.
    pub fn holds(&self, fact: u32, value: bool) -> bool {
        self.facts[fact as usize].value == value
    }

    /// First time at which a fact had the value and may be read [s]; infinite if never.
    pub fn available(&self, model: &Model, fact: u32, value: bool) -> f64 {
        let stamp = &self.facts[fact as usize];
        let window = model.window_of[fact as usize];
        if window != NONE {
            let past = self.windows[window as usize]
                .iter()
                .find(|(_, _, past)| *past == value);
            if let Some((from, _, _)) = past {
                return from.max(0.0);
            }
        }
        if stamp.value == value {
            stamp.changed.max(0.0)
        } else {
            f64::INFINITY
        }
    }

    /// The value of an expression; `overlay` holds newer values of single fluents.
    pub fn evaluate(
        &self,
        expression: &GroundExpression,
        duration: f64,
        overlay: &[(u32, f64)],
    ) -> f64 {
        match expression {
            GroundExpression::Constant(value) => *value,
            GroundExpression::Fluent(fluent) => overlay
                .iter()
                .rev()
                .find(|(other, _)| *other == fluent.0)
                .map_or_else(|| self.fluents[fluent.index()].value, |(_, value)| *value),
            GroundExpression::Duration => duration,
            GroundExpression::TotalTime => self.makespan,
            GroundExpression::Call(_) => f64::NAN,
            GroundExpression::Binary(operation, left, right) => operation.apply(
                self.evaluate(left, duration, overlay),
                self.evaluate(right, duration, overlay),
            ),
        }
    }

    /// Whether a comparison holds.
    pub fn compares(&self, comparing: &Comparing, duration: f64, overlay: &[(u32, f64)]) -> bool {
        let condition = &comparing.condition;
        condition.comparison.holds(
            self.evaluate(&condition.left, duration, overlay),
            self.evaluate(&condition.right, duration, overlay),
        )
    }

    pub(super) fn journal_fact(&mut self, fact: u32) {
        self.fact_journal.push((fact, self.facts[fact as usize]));
    }

    pub(super) fn journal_fluent(&mut self, fluent: u32) {
        self.fluent_journal
            .push((fluent, self.fluents[fluent as usize]));
    }
}

pub fn combine(assignment: Assignment, old: f64, value: f64) -> f64 {
    match assignment {
        Assignment::Assign => value,
        Assignment::Increase => old + value,
        Assignment::Decrease => old - value,
        Assignment::ScaleUp => old * value,
        Assignment::ScaleDown => old / value,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::State;
    use crate::schedule::model::Model;
    use crate::schedule::testing::{FACTORY, task};

    proptest! {
        #[test]
        fn rolling_back_restores_everything(choices in prop::collection::vec(any::<u32>(), 0..12), keep in 0usize..12) {
            let task = task(FACTORY);
            let model = Model::new(&task).expect("supported");
            let mut state = State::new(&model, &task);
            let mut before = None;
            for (index, choice) in choices.iter().enumerate() {
                if index == keep {
                    before = Some((state.mark(), format!("{:?} {:?} {:?}", state.facts, state.truth, state.list)));
                }
                let operator = choice % task.operators.len() as u32;
                if let Some(dispatch) = state.earliest(&model, operator) {
                    state.apply(&model, dispatch);
                }
            }
            if let Some((mark, text)) = before {
                state.rollback(mark);
                prop_assert_eq!(text, format!("{:?} {:?} {:?}", state.facts, state.truth, state.list));
            }
        }
    }

    fn apply_all(state: &mut State, model: &Model, operators: &[u32]) -> Vec<u32> {
        let mut applied = Vec::new();
        for operator in operators {
            if let Some(dispatch) = state.earliest(model, *operator) {
                state.apply(model, dispatch);
                applied.push(*operator);
            }
        }
        applied
    }

    proptest! {
        #[test]
        fn a_list_with_the_same_beginning_is_the_same_schedule(
            before in prop::collection::vec(any::<u32>(), 0..12),
            after in prop::collection::vec(any::<u32>(), 0..8),
            keep in 0usize..12,
        ) {
            let task = task(FACTORY);
            let model = Model::new(&task).expect("supported");
            let operators = |choices: &[u32]| -> Vec<u32> {
                choices.iter().map(|choice| choice % task.operators.len() as u32).collect()
            };
            let mut state = State::new(&model, &task);
            let applied = apply_all(&mut state, &model, &operators(&before));
            let mut wanted: Vec<u32> = applied.iter().copied().take(keep).collect();
            wanted.extend(operators(&after));

            let kept = state.keep_beginning(wanted.iter().copied());
            prop_assert!(kept >= keep.min(applied.len()));
            apply_all(&mut state, &model, &wanted[kept..]);
            let mut anew = State::new(&model, &task);
            apply_all(&mut anew, &model, &wanted);
            let shown = |state: &State| format!("{:?} {:?} {:?} {:?} {:?}", state.facts, state.fluents, state.truth, state.list, state.makespan);
            prop_assert_eq!(shown(&state), shown(&anew));
        }
    }

    #[test]
    fn later_operators_may_start_earlier() {
        let task = task(FACTORY);
        let model = Model::new(&task).expect("supported");
        let mut state = State::new(&model, &task);
        let mut starts = Vec::new();
        for name in ["prime", "paint", "sweep"] {
            let operator = (0..task.operators.len() as u32)
                .find(|operator| task.operator_name(crate::task::OperatorId(*operator)) == name);
            let dispatch = state.earliest(&model, operator.expect("grounded"));
            let dispatch = dispatch.expect("applicable");
            state.apply(&model, dispatch);
            starts.push(dispatch.start);
        }
        assert_eq!(starts, [0.0, 4.001, 0.0]);
    }
}
