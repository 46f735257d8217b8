//! The conjunctions that a ground condition splits into, over facts.

use crate::task::Conjunction;

use super::super::GroundingError;
use super::super::formula::Formula;
use super::super::reachability::{Instance, instance_name};
use super::super::schema::Origin;
use super::Assembly;

impl Assembly<'_, '_> {
    /// The conjunctions that a formula splits into.
    pub(super) fn conjunctions(
        &mut self,
        formula: Formula,
        instance: Option<&Instance>,
    ) -> Result<Vec<Conjunction>, GroundingError> {
        if let Some(plain) = self.plain(&formula) {
            return Ok(plain.into_iter().collect());
        }
        let folded = formula.fold(&|atom| self.known(atom));
        let limit = self.limits.disjuncts;
        let Some(disjuncts) = folded.disjuncts(limit) else {
            let (action, span) = match instance {
                Some(instance) => {
                    let schema = &self.reached.schemas[instance.schema as usize];
                    let span = match schema.origin {
                        Origin::Action(_, action) => action.span,
                        Origin::Rule(rule) => rule.span,
                    };
                    (instance_name(self.world, schema, &instance.arguments), span)
                }
                None => ("the goal".into(), self.world.problem.goal.span),
            };
            return Err(GroundingError::TooManyDisjuncts {
                action,
                limit,
                span,
            });
        };
        Ok(disjuncts
            .into_iter()
            .filter_map(|literals| self.conjunction(literals))
            .collect())
    }

    /// The same for literals and conjunctions of them, which most conditions are.
    fn plain(&mut self, formula: &Formula) -> Option<Option<Conjunction>> {
        let literals = match formula {
            Formula::And(literals) => literals.as_slice(),
            Formula::Or(_) => return None,
            literal => std::slice::from_ref(literal),
        };
        let nested = |part: &Formula| matches!(part, Formula::And(_) | Formula::Or(_));
        if literals.iter().any(nested) {
            return None;
        }
        let mut open = Vec::with_capacity(literals.len());
        for literal in literals {
            match literal {
                Formula::False => return Some(None),
                Formula::Atom(atom, positive) => match self.known(*atom) {
                    Some(value) if value == *positive => {}
                    Some(_) => return Some(None),
                    None => {
                        let opposite = Formula::Atom(*atom, !positive);
                        if open.contains(&&opposite) {
                            return Some(None);
                        }
                        open.push(literal);
                    }
                },
                other => open.push(other),
            }
        }
        Some(self.conjunction(open.into_iter().cloned()))
    }

    fn conjunction(&mut self, literals: impl IntoIterator<Item = Formula>) -> Option<Conjunction> {
        let mut conjunction = Conjunction::default();
        for literal in literals {
            match literal {
                Formula::Atom(atom, true) => conjunction.positive.push(self.fact(atom)),
                Formula::Atom(atom, false) => conjunction.negative.push(self.fact(atom)),
                Formula::Compare(condition) => {
                    if !conjunction.comparisons.contains(&condition) {
                        conjunction.comparisons.push(condition);
                    }
                }
                Formula::Call(call, value) => {
                    if !conjunction.calls.contains(&(call, value)) {
                        conjunction.calls.push((call, value));
                    }
                }
                Formula::True => {}
                Formula::False | Formula::And(_) | Formula::Or(_) => return None,
            }
        }
        conjunction.positive.sort_unstable();
        conjunction.positive.dedup();
        conjunction.negative.sort_unstable();
        conjunction.negative.dedup();
        let clash = conjunction
            .positive
            .iter()
            .any(|fact| conjunction.negative.binary_search(fact).is_ok());
        (!clash).then_some(conjunction)
    }
}
