//! Numbers for the literals and comparisons that conditions mention.

use rustc_hash::FxHashMap;

use crate::schedule::model::{Comparing, Model, NONE, When, fluents_of, literals};
use crate::schedule::propositions::{Meaning, Term};
use crate::task::{Conjunction, GroundExpression, NumericCondition};

#[derive(Default)]
pub(super) struct Numbering {
    pub(super) negation_of: Vec<u32>,
    pub(super) extra: Vec<Meaning>,
    pub(super) comparisons: Vec<Comparing>,
    pub(super) seen: FxHashMap<String, u32>,
    pub(super) by_fluent: FxHashMap<u32, Vec<u32>>,
    /// By fact: least lengths [s] and propositions.
    pub(super) lasting: FxHashMap<u32, Vec<(f64, u32)>>,
    /// Changes of fluents by how they are written.
    pub(super) change_of: FxHashMap<String, u32>,
    /// Each change with the comparisons that it may make true.
    pub(super) consequences: Vec<(u32, Vec<u32>)>,
}

impl Numbering {
    pub(super) fn literal(&mut self, fact: u32, value: bool) -> u32 {
        if value {
            return fact;
        }
        let next = (self.negation_of.len() + self.extra.len()) as u32;
        let slot = &mut self.negation_of[fact as usize];
        if *slot == NONE {
            *slot = next;
            self.extra.push(Meaning::Literal(fact, false));
        }
        *slot
    }

    /// That a fact holds for at least this long [s]. As many propositions as there are lengths of
    /// the windows that operators open; the fact itself if it has none, or if the time is unknown.
    pub(super) fn lasting(&mut self, model: &Model, fact: u32, duration: f64) -> u32 {
        let window = model.window_of[fact as usize];
        if window == NONE || duration.is_nan() {
            return fact;
        }
        let lengths = &model.window_lengths[window as usize];
        if lengths.is_empty() {
            return fact;
        }
        let mut lengths = lengths.iter().copied();
        let length = lengths.find(|length| *length >= duration);
        let length = length.unwrap_or(f64::INFINITY);
        let known = self.lasting.entry(fact).or_default();
        if let Some((_, proposition)) = known.iter().find(|entry| entry.0 == length) {
            return *proposition;
        }
        let proposition = (self.negation_of.len() + self.extra.len()) as u32;
        known.push((length, proposition));
        self.extra.push(Meaning::Lasting(fact, length));
        proposition
    }

    /// What a window of this length [s] is long enough for.
    pub(super) fn lasting_up_to(&self, fact: u32, duration: f64) -> impl Iterator<Item = u32> + '_ {
        let known = self.lasting.get(&fact).into_iter().flatten();
        // A length that is not known may be any.
        let suits = move |entry: &&(f64, u32)| duration.is_nan() || entry.0 <= duration;
        known.filter(suits).map(|entry| entry.1)
    }

    /// A change of a fluent that has not been met before, with what may follow from it.
    pub(super) fn change(&mut self, written: String, comparisons: Vec<u32>) -> u32 {
        let proposition = (self.negation_of.len() + self.extra.len()) as u32;
        self.extra.push(Meaning::Change);
        self.consequences.push((proposition, comparisons));
        self.change_of.insert(written, proposition);
        proposition
    }

    pub(super) fn comparison(&mut self, condition: &NumericCondition) -> u32 {
        let key = format!("{condition:?}");
        if let Some(seen) = self.seen.get(&key) {
            return *seen;
        }
        let proposition = (self.negation_of.len() + self.extra.len()) as u32;
        let mut reads = Vec::new();
        let _ = fluents_of(&condition.left, &mut reads);
        let _ = fluents_of(&condition.right, &mut reads);
        for fluent in &reads {
            self.by_fluent.entry(*fluent).or_default().push(proposition);
        }
        self.extra
            .push(Meaning::Numeric(self.comparisons.len() as u32));
        self.comparisons.push(Comparing {
            condition: condition.clone(),
            when: When::Start,
            reads,
        });
        self.seen.insert(key, proposition);
        proposition
    }

    pub(super) fn conjunction(
        &mut self,
        condition: &Conjunction,
        at_end: bool,
        needs: &mut Vec<Term>,
    ) {
        for (fact, value) in literals(condition) {
            let proposition = self.literal(fact, value);
            needs.push(Term {
                proposition,
                at_end,
                throughout: true,
            });
        }
        for comparison in &condition.comparisons {
            if !uses_duration(comparison) {
                let proposition = self.comparison(comparison);
                needs.push(Term {
                    proposition,
                    at_end,
                    throughout: true,
                });
            }
        }
    }
}

/// Whether a condition can be told only when its action starts.
pub(super) fn uses_duration(condition: &NumericCondition) -> bool {
    fn walk(expression: &GroundExpression) -> bool {
        match expression {
            GroundExpression::Duration => true,
            GroundExpression::Binary(_, left, right) => walk(left) || walk(right),
            _ => false,
        }
    }
    walk(&condition.left) || walk(&condition.right)
}
