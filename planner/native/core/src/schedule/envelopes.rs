//! Operators that are there for what happens while they run: a match that burns, a kiln that is hot.
//!
//! Started as soon as possible they would be over before they are needed. An envelope therefore waits
//! until an operator cannot do without it, starts when that one can, and in the finished list as much
//! earlier as what happens in it allows, so that it ends as early as it can. (Envelopes and contents
//! as in Coles et al., "Planning with problems requiring temporal coordination", AAAI 2008.)

use crate::schedule::model::{EPSILON, NONE, When};
use crate::schedule::state::Dispatch;
use crate::schedule::workshop::Workshop;

impl Workshop {
    /// Appends an operator at its earliest start, with the waiting envelopes that it needs; its end,
    /// or `None` if it does not apply. An envelope itself waits, and has no end yet.
    pub fn append(&mut self, operator: u32) -> Option<f64> {
        if self.model.shapes[operator as usize].envelope {
            // It may have to be inside others that wait.
            let (facts, _) = self.supplied(operator);
            self.state
                .earliest_from(&self.model, operator, 0.0, &facts)?;
            self.waiting.push(operator);
            return Some(0.0);
        }
        let dispatch = self.state.earliest(&self.model, operator);
        if let Some(dispatch) = dispatch {
            self.state.apply(&self.model, dispatch);
            return Some(dispatch.end());
        }
        if self.waiting.is_empty() {
            return None;
        }
        let mark = self.state.mark();
        let waiting = self.waiting.clone();
        let dispatch = self.inside(operator, 0.0).or_else(|| {
            // It may need what else they do.
            self.state.rollback(mark);
            for envelope in std::mem::take(&mut self.waiting) {
                if let Some(dispatch) = self.state.earliest(&self.model, envelope) {
                    self.state.apply(&self.model, dispatch);
                }
            }
            self.state.earliest(&self.model, operator)
        });
        if dispatch.is_none() {
            self.state.rollback(mark);
            self.waiting = waiting;
        }
        let dispatch = dispatch?;
        self.state.apply(&self.model, dispatch);
        Some(dispatch.end())
    }

    /// The facts that an operator needs and waiting envelopes make true for long enough, and the
    /// positions of these.
    fn supplied(&self, operator: u32) -> (Vec<u32>, Vec<usize>) {
        if self.waiting.is_empty() {
            return (Vec::new(), Vec::new());
        }
        let duration = self.model.shapes[operator as usize].duration;
        let (mut facts, mut envelopes) = (Vec::new(), Vec::new());
        for read in self.model.reads(operator) {
            if read.own || !read.value || self.model.window_of[read.fact as usize] == NONE {
                continue;
            }
            let suits = |envelope: &u32| {
                let lasts = self.model.shapes[*envelope as usize].duration;
                let adds = |write: &crate::schedule::model::Write| {
                    write.fact == read.fact && write.value && !write.at_end
                };
                (read.when != When::Throughout || lasts >= duration)
                    && self.model.writes(*envelope).iter().any(adds)
            };
            if let Some(index) = self.waiting.iter().position(suits) {
                facts.push(read.fact);
                envelopes.push(index);
            }
        }
        envelopes.sort_unstable();
        envelopes.dedup();
        (facts, envelopes)
    }

    /// Starts waiting envelopes around an operator that is to start at `release` [s] or later.
    fn inside(&mut self, operator: u32, release: f64) -> Option<Dispatch> {
        let open = self
            .state
            .earliest_from(&self.model, operator, release, &[]);
        if open.is_some() {
            return open;
        }
        let (facts, envelopes) = self.supplied(operator);
        let alone = self
            .state
            .earliest_from(&self.model, operator, release, &facts)?;
        if envelopes.is_empty() {
            return Some(alone);
        }
        let envelopes: Vec<u32> = envelopes
            .into_iter()
            .rev()
            .map(|index| self.waiting.remove(index))
            .collect();
        for envelope in envelopes.into_iter().rev() {
            let from = self.state.earliest(&self.model, envelope);
            // It may have to be inside another one.
            let dispatch = self.inside(envelope, alone.start)?;
            let earliest = match from {
                Some(from) if self.is_free(envelope) => from.start,
                _ => dispatch.start,
            };
            self.state.apply(
                &self.model,
                Dispatch {
                    earliest,
                    ..dispatch
                },
            );
        }
        self.state
            .earliest_from(&self.model, operator, release, &[])
    }

    /// Whether an envelope touches no fact with windows but those that it opens: only then may it
    /// start earlier afterwards.
    fn is_free(&self, envelope: u32) -> bool {
        let has_windows = |fact: u32| self.model.window_of[fact as usize] != NONE;
        let mut reads = self.model.reads(envelope).iter();
        let writes = self.model.writes(envelope);
        let opens = |fact: u32| {
            let mut writes = writes.iter();
            writes.any(|write| write.fact == fact && write.value && !write.at_end)
        };
        reads.all(|read| read.own || !has_windows(read.fact))
            && writes
                .iter()
                .all(|write| opens(write.fact) || !has_windows(write.fact))
    }

    /// Whether an envelope is waiting that makes a proposition true.
    pub(super) fn awaited(&self, proposition: u32) -> bool {
        !self.waiting.is_empty()
            && self
                .propositions
                .adding
                .row(proposition)
                .iter()
                .any(|rule| {
                    let rule = &self.propositions.rules[*rule as usize];
                    self.waiting.contains(&rule.operator)
                })
    }

    /// Starts the envelopes of the finished list as early as what happens in them allows. The stamps
    /// of the state are left as they are: nothing can be appended afterwards.
    pub(super) fn tighten_envelopes(&mut self) {
        self.waiting.clear();
        let count = self.state.list.len();
        let mut moved = false;
        for index in 0..count {
            let envelope = self.state.list[index];
            if envelope.earliest >= envelope.start {
                continue;
            }
            let Some(needed_until) = self.needed_until(index) else {
                continue;
            };
            let start = envelope.earliest.max(needed_until - envelope.duration);
            if start < envelope.start {
                self.state.list[index].start = start;
                moved = true;
            }
        }
        if moved {
            let ends = self.state.list.iter().map(Dispatch::end);
            self.state.makespan = ends.fold(0.0, f64::max);
        }
    }

    /// Until when an envelope of the list must not end [s]; `None` if it has to stay where it is.
    fn needed_until(&self, index: usize) -> Option<f64> {
        let envelope = self.state.list[index];
        let mut until = 0.0f64;
        for (other, content) in self.state.list.iter().enumerate() {
            if other == index || content.end() < envelope.earliest {
                continue;
            }
            for read in self.model.reads(content.operator) {
                let window = self.model.window_of[read.fact as usize];
                let opens = window != NONE
                    && self
                        .model
                        .writes(envelope.operator)
                        .iter()
                        .any(|write| write.fact == read.fact && write.value && !write.at_end);
                if !opens || read.own {
                    continue;
                }
                if !read.value {
                    return None;
                }
                let needed = match read.when {
                    When::Start => content.start + EPSILON,
                    When::Throughout => content.end(),
                    When::End => content.end() + EPSILON,
                };
                let inside = content.start >= envelope.start && content.start < envelope.end();
                if inside {
                    until = until.max(needed);
                }
            }
            let mentions = self.model.detail(content.operator);
            if mentions.is_some_and(|detail| !detail.mentions.is_empty()) {
                return None;
            }
        }
        Some(until)
    }
}
