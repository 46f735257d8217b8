//! Time-stamped states.

use crate::task::{FactId, OperatorId};

use super::calls::Snapshot;
use super::compiled::Compiled;

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

/// One of the happenings of the last [`EPSILON`](crate::plan::EPSILON) seconds.
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
    /// What happened within the last [`EPSILON`](crate::plan::EPSILON) seconds, with its time.
    pub recent: Vec<(f64, Event)>,
}

impl State {
    /// The state at time 0, without derived facts.
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
        state
    }

    /// Whether a fact holds.
    #[inline]
    #[must_use]
    pub fn holds(&self, fact: FactId) -> bool {
        self.facts[fact.index() / 64] & (1 << (fact.index() % 64)) != 0
    }

    pub(super) fn set(&mut self, fact: FactId, value: bool) {
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
