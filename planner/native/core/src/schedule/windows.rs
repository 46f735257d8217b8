//! Reading a fact in an interval of the past in which it had the value.

use crate::schedule::model::{EPSILON, Model, NONE, When};
use crate::schedule::propositions::{Meaning, Propositions};
use crate::schedule::state::State;

impl State {
    pub(super) fn fit_windows(
        &self,
        model: &Model,
        operator: u32,
        mut start: f64,
        duration: f64,
        without: &[u32],
    ) -> Option<f64> {
        loop {
            let before = start;
            for read in model.reads(operator) {
                let window = model.window_of[read.fact as usize];
                if read.own || window == NONE || without.contains(&read.fact) {
                    continue;
                }
                start = self.fit(read.fact, window, read.value, read.when, start, duration)?;
            }
            let mentions = model.detail(operator).map_or(&[][..], |d| &d.mentions);
            for &(fact, at_end) in mentions {
                let window = model.window_of[fact as usize];
                if window == NONE {
                    continue;
                }
                // Whatever its value, as long as nothing writes it at that moment.
                let when = if at_end { When::End } else { When::Start };
                let [low, high] =
                    [false, true].map(|value| self.fit(fact, window, value, when, start, duration));
                start = match (low, high) {
                    (Some(low), Some(high)) => low.min(high),
                    (one, other) => one.or(other)?,
                };
            }
            if start <= before {
                return Some(start);
            }
        }
    }

    /// The longest past interval in which a fact with windows held [s].
    pub fn longest_window(&self, model: &Model, fact: u32) -> f64 {
        let window = model.window_of[fact as usize];
        if window == NONE {
            return 0.0;
        }
        let held = self.windows[window as usize].iter().filter(|past| past.2);
        held.map(|(from, until, _)| until - from)
            .fold(0.0, f64::max)
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
}

impl Propositions {
    /// Whether a fact that does not hold any more was true for as long as a proposition asks.
    pub fn held_once(&self, model: &Model, state: &State, lasting: u32) -> bool {
        let index = (lasting - self.fact_count) as usize;
        let Meaning::Lasting(fact, length) = self.extra[index] else {
            return false;
        };
        if state.holds(fact, true) {
            return false;
        }
        let window = model.window_of[fact as usize];
        let known = model.window_lengths[window as usize].iter().copied();
        let longest = state.longest_window(model, fact);
        // Differences of times are not exact.
        longest >= length - 1e-6 || longest > known.fold(0.0, f64::max)
    }
}
