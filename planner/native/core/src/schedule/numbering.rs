//! Numbers for the literals and comparisons that conditions mention.

use rustc_hash::FxHashMap;

use crate::schedule::model::{Comparing, NONE, When, fluents_of, literals};
use crate::schedule::propositions::{Meaning, Term};
use crate::task::{Conjunction, GroundExpression, NumericCondition};

#[derive(Default)]
pub(super) struct Numbering {
    pub(super) negation_of: Vec<u32>,
    pub(super) extra: Vec<Meaning>,
    pub(super) comparisons: Vec<Comparing>,
    pub(super) seen: FxHashMap<String, u32>,
    pub(super) by_fluent: FxHashMap<u32, Vec<u32>>,
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
