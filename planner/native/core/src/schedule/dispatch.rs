//! The earliest start of an operator behind a list.

use crate::schedule::model::{
    ConditionalWrite, Detail, EPSILON, Model, NONE, NumericWrite, When, for_reads,
};
use crate::schedule::state::{Dispatch, State, combine};
use crate::task::GroundExpression;

impl State {
    /// Earliest dispatch of an operator behind this list; `None` if it is not applicable.
    pub fn earliest(&self, model: &Model, operator: u32) -> Option<Dispatch> {
        self.earliest_from(model, operator, 0.0, &[])
    }

    /// The same, not before `release` [s] and without asking for some facts with windows.
    pub fn earliest_from(
        &self,
        model: &Model,
        operator: u32,
        release: f64,
        without: &[u32],
    ) -> Option<Dispatch> {
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
        let mut start = release;
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
            for &(fact, at_end) in &detail.mentions {
                if model.window_of[fact as usize] != NONE {
                    windowed = true;
                    continue;
                }
                let lag = if at_end { duration } else { 0.0 };
                start = start.max(self.facts[fact as usize].changed + EPSILON - lag);
            }
        }
        if windowed {
            start = self.fit_windows(model, operator, start, duration, without)?;
        }
        Some(Dispatch {
            operator,
            start,
            duration,
            earliest: start,
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

    pub(super) fn fired_fluents<'d>(
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
    pub(super) fn fires(&self, effect: &ConditionalWrite, duration: f64) -> bool {
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

    /// Whether an operator makes a goal false that holds.
    pub fn destroys_goal(&self, model: &Model, operator: u32) -> bool {
        model.threatens_goal[operator as usize]
            && model.writes(operator).iter().any(|write| {
                model.goal_value[write.fact as usize] == Some(!write.value)
                    && self.holds(write.fact, !write.value)
                    && !model.writes(operator).iter().any(|other| {
                        other.fact == write.fact && other.value != write.value && other.at_end
                    })
            })
    }
}
