//! Appending a dispatched operator to a schedule: stamps of what it reads and writes.

use crate::pddl::model::Assignment;
use crate::schedule::model::{Detail, Model, NONE, NumericWrite, When, for_reads};
use crate::schedule::state::{Dispatch, State, combine};

impl State {
    /// Appends a dispatched operator.
    pub fn apply(&mut self, model: &Model, dispatch: Dispatch) {
        let Dispatch {
            operator,
            start,
            duration,
            ..
        } = dispatch;
        let end = start + duration;
        let before = self.mark();
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
        if fired.is_empty() {
            for index in from..to {
                let write = model.writes[index as usize];
                let time = if write.at_end { end } else { start };
                self.write(model, write.fact, write.value, time);
            }
        } else {
            let certain = model.writes(operator).iter().map(|write| {
                let time = if write.at_end { end } else { start };
                (write.fact, write.value, write.at_end, time)
            });
            let mut writes: Vec<_> = certain.chain(fired).collect();
            // The end after the start; of one happening's writes an add comes last and prevails.
            writes.sort_by_key(|(fact, value, at_end, _)| (*at_end, *fact, *value));
            for (index, (fact, value, at_end, time)) in writes.iter().enumerate() {
                let prevails = writes.get(index + 1);
                let undone = |next: &(u32, bool, bool, f64)| (next.0, next.2) == (*fact, *at_end);
                if !prevails.is_some_and(undone) {
                    self.write(model, *fact, *value, *time);
                }
            }
        }
        self.push(dispatch, before);
    }

    /// Stamps what the rarer parts read, changes fluents; returns the conditional writes that
    /// happen as (fact, value, at end, time).
    fn apply_detail(
        &mut self,
        detail: &Detail,
        start: f64,
        duration: f64,
    ) -> Vec<(u32, bool, bool, f64)> {
        let end = start + duration;
        for &(fact, at_end) in &detail.mentions {
            self.journal_fact(fact);
            let stamp = &mut self.facts[fact as usize];
            stamp.read = stamp.read.max(if at_end { end } else { start });
        }
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
                fired.push((fact, value, effect.at_end, time));
            }
        }
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

    pub(super) fn assign(&mut self, assignment: Assignment, fluent: u32, value: f64, time: f64) {
        self.journal_fluent(fluent);
        let stamp = &mut self.fluents[fluent as usize];
        stamp.value = combine(assignment, stamp.value, value);
        stamp.changed = stamp.changed.max(time);
        if !matches!(assignment, Assignment::Increase | Assignment::Decrease) {
            stamp.assigned = stamp.assigned.max(time);
        }
    }

    pub(super) fn write(&mut self, model: &Model, fact: u32, value: bool, time: f64) {
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
}
