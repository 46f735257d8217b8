//! A list schedule under construction: every fact and fluent knows when it was last changed and
//! read, every operator is dispatched at its earliest start, every step can be undone.
//!
//! Soundness: the happenings that touch one fact (or fluent) happen in the order of the list and
//! interfering ones are [`EPSILON`] apart, so each operator reads in time what it read in the
//! list; operators further down the list may nevertheless start earlier.

use crate::pddl::model::Assignment;
use crate::schedule::model::{
    Comparing, ConditionalWrite, Detail, EPSILON, Model, NONE, NumericWrite, When,
};
use crate::task::{Change, Conjunction, GroundExpression, Task};

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
type Window = (f64, f64, bool);

/// One dispatched operator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dispatch {
    pub operator: u32,
    pub start: f64,
    pub duration: f64,
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
    pub makespan: f64,
    windows: Vec<Vec<Window>>,
    fact_journal: Vec<(u32, FactStamp)>,
    fluent_journal: Vec<(u32, FluentStamp)>,
    window_journal: Vec<u32>,
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

    fn set_truth(&mut self, fact: u32, value: bool) {
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

    /// Earliest dispatch of an operator behind this list; `None` if it is not applicable.
    pub fn earliest(&self, model: &Model, operator: u32) -> Option<Dispatch> {
        let shape = &model.shapes[operator as usize];
        if shape.excluded {
            return None;
        }
        let detail = model.detail(operator);
        let duration = match detail.and_then(|detail| detail.bounds.as_ref()) {
            None => shape.duration,
            Some((low, high, _)) => {
                let low = self.evaluate(low, 0.0, &[]);
                let high = self.evaluate(high, 0.0, &[]);
                if low.is_nan() || high.is_nan() || low > high {
                    return None;
                }
                let duration = if low.is_finite() { low.max(0.0) } else { high };
                if !duration.is_finite() {
                    return None;
                }
                if duration < EPSILON {
                    // Start and end would be one happening.
                    if high < EPSILON {
                        return None;
                    }
                    EPSILON
                } else {
                    duration
                }
            }
        };
        let mut start = 0.0f64;
        let mut windowed = false;
        for read in model.reads(operator) {
            if read.own {
                continue;
            }
            if model.window_of[read.fact as usize] != NONE {
                windowed = true;
                continue;
            }
            let stamp = &self.facts[read.fact as usize];
            if stamp.value != read.value {
                return None;
            }
            start = start.max(match read.when {
                When::Start => stamp.changed + EPSILON,
                When::Throughout => stamp.since,
                When::End => stamp.changed + EPSILON - duration,
            });
        }
        for write in model.writes(operator) {
            if write.after_own {
                continue;
            }
            let offset = if write.at_end { duration } else { 0.0 };
            start = start.max(self.writable(write.fact, write.value) - offset);
        }
        if let Some(detail) = detail {
            start = start.max(self.detailed(detail, duration)?);
        }
        if windowed {
            start = self.fit_windows(model, operator, start, duration)?;
        }
        Some(Dispatch {
            operator,
            start,
            duration,
        })
    }

    /// Earliest time at which a fact may be written [s].
    fn writable(&self, fact: u32, value: bool) -> f64 {
        let stamp = &self.facts[fact as usize];
        if stamp.value == value {
            stamp.since.max(stamp.read + EPSILON)
        } else {
            (stamp.changed + EPSILON)
                .max(stamp.read + EPSILON)
                .max(stamp.hold)
        }
    }

    /// Earliest start that the numeric and conditional parts allow [s].
    fn detailed(&self, detail: &Detail, duration: f64) -> Option<f64> {
        let mut start = 0.0f64;
        if let Some((_, _, reads)) = &detail.bounds {
            for fluent in reads {
                start = start.max(self.fluents[*fluent as usize].changed + EPSILON);
            }
        }
        let mut overlay = Vec::new();
        for comparing in &detail.comparisons {
            if comparing.when == When::Start && !self.compares(comparing, duration, &overlay) {
                return None;
            }
        }
        for (write, at_end) in self.fired_fluents(detail, duration, false) {
            start = start.max(self.fluent_writable(write, at_end, duration));
            let value = self.changed_value(write, duration, &overlay);
            if value.is_nan() {
                return None;
            }
            overlay.push((write.fluent.0, value));
        }
        for comparing in &detail.comparisons {
            if comparing.when != When::Start && !self.compares(comparing, duration, &overlay) {
                return None;
            }
            for fluent in &comparing.reads {
                let changed = self.fluents[*fluent as usize].changed;
                start = start.max(match comparing.when {
                    When::Start => changed + EPSILON,
                    When::Throughout => changed,
                    When::End => changed + EPSILON - duration,
                });
            }
        }
        for (write, at_end) in self.fired_fluents(detail, duration, true) {
            start = start.max(self.fluent_writable(write, at_end, duration));
        }
        for conditional in &detail.conditional {
            start = start.max(self.conditional_start(conditional, duration));
        }
        Some(start)
    }

    fn fluent_writable(&self, write: &NumericWrite, at_end: bool, duration: f64) -> f64 {
        let offset = if at_end { duration } else { 0.0 };
        let stamp = &self.fluents[write.fluent.index()];
        let mut time = (stamp.assigned + EPSILON)
            .max(stamp.read + EPSILON)
            .max(stamp.hold);
        if !write.additive() {
            time = time.max(stamp.changed + EPSILON);
        }
        for fluent in &write.reads {
            time = time.max(self.fluents[*fluent as usize].changed + EPSILON);
        }
        time - offset
    }

    fn changed_value(&self, write: &NumericWrite, duration: f64, overlay: &[(u32, f64)]) -> f64 {
        let value = self.evaluate(&write.value, duration, overlay);
        let old = self.evaluate(&GroundExpression::Fluent(write.fluent), duration, overlay);
        combine(write.assignment, old, value)
    }

    fn fired_fluents<'d>(
        &self,
        detail: &'d Detail,
        duration: f64,
        at_end: bool,
    ) -> impl Iterator<Item = (&'d NumericWrite, bool)> {
        let conditional: Vec<&NumericWrite> = detail
            .conditional
            .iter()
            .filter(|effect| effect.at_end == at_end && effect.fluent.is_some())
            .filter(|effect| self.fires(effect, duration))
            .filter_map(|effect| effect.fluent.as_ref())
            .collect();
        detail
            .numeric
            .iter()
            .filter(move |write| write.at_end == at_end)
            .chain(conditional)
            .map(move |write| (write, at_end))
    }

    /// Whether a conditional effect happens. Conditions are read in the state before the operator;
    /// a task where an operator's own start effect decides them is refused by the caller.
    fn fires(&self, effect: &ConditionalWrite, duration: f64) -> bool {
        effect.condition.iter().all(|part| {
            part.positive.iter().all(|fact| self.holds(fact.0, true))
                && part.negative.iter().all(|fact| self.holds(fact.0, false))
                && part.comparisons.iter().all(|condition| {
                    condition.comparison.holds(
                        self.evaluate(&condition.left, duration, &[]),
                        self.evaluate(&condition.right, duration, &[]),
                    )
                })
        })
    }

    fn conditional_start(&self, effect: &ConditionalWrite, duration: f64) -> f64 {
        let mut start = 0.0f64;
        let offset = if effect.at_end { duration } else { 0.0 };
        for_reads(&effect.condition, |index, fact, fluents| {
            // The third part is read when the effect happens.
            let lag = if index == 2 { offset } else { 0.0 };
            if let Some(fact) = fact {
                start = start.max(self.facts[fact as usize].changed + EPSILON - lag);
            }
            for fluent in fluents {
                start = start.max(self.fluents[*fluent as usize].changed + EPSILON - lag);
            }
        });
        let fires = self.fires(effect, duration);
        if let (true, Some((fact, value))) = (fires, effect.fact) {
            // Written whatever its value: be as strict as for a real change.
            start = start.max(self.writable(fact, value) - offset);
            start = start.max(self.writable(fact, !value) - offset);
        }
        start
    }

    fn fit_windows(
        &self,
        model: &Model,
        operator: u32,
        mut start: f64,
        duration: f64,
    ) -> Option<f64> {
        loop {
            let before = start;
            for read in model.reads(operator) {
                let window = model.window_of[read.fact as usize];
                if read.own || window == NONE {
                    continue;
                }
                start = self.fit(read.fact, window, read.value, read.when, start, duration)?;
            }
            if start <= before {
                return Some(start);
            }
        }
    }

    fn fit(
        &self,
        fact: u32,
        window: u32,
        value: bool,
        when: When,
        start: f64,
        duration: f64,
    ) -> Option<f64> {
        let stamp = &self.facts[fact as usize];
        let past = self.windows[window as usize]
            .iter()
            .map(|(from, until, value)| (*from, *from, *until, *value));
        let now = (stamp.since, stamp.changed, f64::INFINITY, stamp.value);
        past.chain(std::iter::once(now))
            .filter(|(_, _, _, past)| *past == value)
            .filter_map(|(since, changed, until, _)| {
                let (from, to) = match when {
                    When::Start => (changed + EPSILON, until - EPSILON),
                    When::Throughout => (since, until - duration),
                    When::End => (changed + EPSILON - duration, until - EPSILON - duration),
                };
                let time = from.max(start);
                (time <= to).then_some(time)
            })
            .reduce(f64::min)
    }

    /// Appends a dispatched operator.
    pub fn apply(&mut self, model: &Model, dispatch: Dispatch) {
        let Dispatch {
            operator,
            start,
            duration,
        } = dispatch;
        let end = start + duration;
        let (from, to) = model.shapes[operator as usize].reads;
        for index in from..to {
            let read = model.reads[index as usize];
            if self.facts[read.fact as usize].value != read.value && !read.own {
                continue; // read in a past window, whose end is settled
            }
            self.journal_fact(read.fact);
            let stamp = &mut self.facts[read.fact as usize];
            match read.when {
                When::Start => stamp.read = stamp.read.max(start),
                When::Throughout => stamp.hold = stamp.hold.max(end),
                When::End => stamp.read = stamp.read.max(end),
            }
        }
        let fired = match model.detail(operator) {
            None => Vec::new(),
            Some(detail) => self.apply_detail(detail, start, duration),
        };
        let (from, to) = model.shapes[operator as usize].writes;
        for index in from..to {
            let write = model.writes[index as usize];
            let time = if write.at_end { end } else { start };
            self.write(model, write.fact, write.value, time);
        }
        for (fact, value, time) in fired {
            // Unconditional and conditional adds win over conditional deletes.
            let added = |write: &crate::schedule::model::Write| {
                write.fact == fact
                    && write.value
                    && (if write.at_end { end } else { start }) == time
            };
            if value || !model.writes(operator).iter().any(added) {
                self.write(model, fact, value, time);
            }
        }
        self.makespan = self.makespan.max(end);
        self.list.push(dispatch);
    }

    fn apply_detail(
        &mut self,
        detail: &Detail,
        start: f64,
        duration: f64,
    ) -> Vec<(u32, bool, f64)> {
        let end = start + duration;
        let mut fired = Vec::new();
        if let Some((_, _, reads)) = &detail.bounds {
            for fluent in reads {
                self.read_fluent(*fluent, start);
            }
        }
        for comparing in &detail.comparisons {
            for fluent in &comparing.reads {
                match comparing.when {
                    When::Start => self.read_fluent(*fluent, start),
                    When::Throughout => {
                        self.journal_fluent(*fluent);
                        let stamp = &mut self.fluents[*fluent as usize];
                        stamp.hold = stamp.hold.max(end);
                    }
                    When::End => self.read_fluent(*fluent, end),
                }
            }
        }
        for effect in &detail.conditional {
            let time = if effect.at_end { end } else { start };
            let mut read_facts = Vec::new();
            let mut read_fluents = Vec::new();
            for_reads(&effect.condition, |index, fact, fluents| {
                let until = if index == 0 { start } else { time };
                read_facts.extend(fact.map(|fact| (fact, until)));
                read_fluents.extend(fluents.iter().map(|fluent| (*fluent, until)));
            });
            for (fact, until) in read_facts {
                self.journal_fact(fact);
                let stamp = &mut self.facts[fact as usize];
                stamp.read = stamp.read.max(until);
            }
            for (fluent, until) in read_fluents {
                self.read_fluent(fluent, until);
            }
            if let (Some((fact, value)), true) = (effect.fact, self.fires(effect, duration)) {
                fired.push((fact, value, time));
            }
        }
        fired.sort_by(|left, right| left.2.total_cmp(&right.2).then(left.1.cmp(&right.1)));
        let end_writes: Vec<NumericWrite> = self
            .fired_fluents(detail, duration, true)
            .map(|(write, _)| write.clone())
            .collect();
        let start_writes: Vec<NumericWrite> = self
            .fired_fluents(detail, duration, false)
            .map(|(write, _)| write.clone())
            .collect();
        for (writes, time) in [(start_writes, start), (end_writes, end)] {
            // Effects of one happening read the values before it.
            let values: Vec<f64> = writes
                .iter()
                .map(|write| self.evaluate(&write.value, duration, &[]))
                .collect();
            for (write, value) in writes.iter().zip(values) {
                for fluent in &write.reads {
                    self.read_fluent(*fluent, time);
                }
                self.assign(write.assignment, write.fluent.0, value, time);
            }
        }
        fired
    }

    fn read_fluent(&mut self, fluent: u32, time: f64) {
        self.journal_fluent(fluent);
        let stamp = &mut self.fluents[fluent as usize];
        stamp.read = stamp.read.max(time);
    }

    fn assign(&mut self, assignment: Assignment, fluent: u32, value: f64, time: f64) {
        self.journal_fluent(fluent);
        let stamp = &mut self.fluents[fluent as usize];
        stamp.value = combine(assignment, stamp.value, value);
        stamp.changed = stamp.changed.max(time);
        if !matches!(assignment, Assignment::Increase | Assignment::Decrease) {
            stamp.assigned = stamp.assigned.max(time);
        }
    }

    fn write(&mut self, model: &Model, fact: u32, value: bool, time: f64) {
        self.journal_fact(fact);
        let stamp = &mut self.facts[fact as usize];
        let old = *stamp;
        stamp.changed = stamp.changed.max(time);
        if old.value != value {
            stamp.value = value;
            stamp.since = time;
            self.set_truth(fact, value);
            let window = model.window_of[fact as usize];
            if window != NONE {
                self.windows[window as usize].push((old.changed, time, old.value));
                self.window_journal.push(window);
            }
        }
    }

    fn journal_fact(&mut self, fact: u32) {
        self.fact_journal.push((fact, self.facts[fact as usize]));
    }

    fn journal_fluent(&mut self, fluent: u32) {
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

/// Visits the facts and fluents that a conditional effect reads, with the part that reads them.
fn for_reads(condition: &[Conjunction; 3], mut visit: impl FnMut(usize, Option<u32>, &[u32])) {
    for (index, part) in condition.iter().enumerate() {
        for (fact, _) in crate::schedule::model::literals(part) {
            visit(index, Some(fact), &[]);
        }
        for comparison in &part.comparisons {
            let mut fluents = Vec::new();
            let _ = crate::schedule::model::fluents_of(&comparison.left, &mut fluents);
            let _ = crate::schedule::model::fluents_of(&comparison.right, &mut fluents);
            visit(index, None, &fluents);
        }
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
