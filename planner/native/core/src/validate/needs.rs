//! Which facts and fluents a condition or an expression reads.

use rustc_hash::FxHashSet;

use super::interference::Symbol;
use super::scene::{Fault, Scene};
use crate::pddl::model::{Condition, ConditionKind, Expression, ExpressionKind, ObjectId};

impl Scene<'_> {
    /// Adds every fact and fluent that a condition mentions, under all bindings of its quantifiers, and for
    /// a derived fact everything that its rules mention.
    pub(super) fn needs(
        &self,
        condition: &Condition,
        bindings: &mut Vec<ObjectId>,
        found: &mut FxHashSet<Symbol>,
    ) -> Result<(), Fault> {
        match &condition.kind {
            ConditionKind::And(parts) | ConditionKind::Or(parts) => {
                for part in parts {
                    self.needs(part, bindings, found)?;
                }
            }
            ConditionKind::Not(part) => self.needs(part, bindings, found)?,
            ConditionKind::Imply(premise, conclusion) => {
                self.needs(premise, bindings, found)?;
                self.needs(conclusion, bindings, found)?;
            }
            ConditionKind::Forall(parameters, part) | ConditionKind::Exists(parameters, part) => {
                self.instance(parameters, bindings, &mut |bindings| {
                    self.needs(part, bindings, found)?;
                    Ok(false)
                })?;
            }
            ConditionKind::Atom(atom) => {
                let tuple = Self::tuple(&atom.arguments, bindings);
                let new = found.insert(Symbol::Fact(atom.predicate, tuple.clone()));
                if new && self.domain.predicates[atom.predicate.index()].derived {
                    for rule in &self.domain.derived {
                        if rule.predicate == atom.predicate {
                            self.needs(&rule.condition, &mut tuple.to_vec(), found)?;
                        }
                    }
                }
            }
            ConditionKind::Compare(_, left, right) => {
                Self::reads(left, bindings, found);
                Self::reads(right, bindings, found);
            }
            ConditionKind::Equal(..) | ConditionKind::Module(_) => {}
        }
        Ok(())
    }

    /// Adds every fluent that an expression reads.
    pub(super) fn reads(
        expression: &Expression,
        bindings: &[ObjectId],
        found: &mut FxHashSet<Symbol>,
    ) {
        match &expression.kind {
            ExpressionKind::Fluent(term) => {
                let tuple = Self::tuple(&term.arguments, bindings);
                found.insert(Symbol::Fluent(term.function, tuple));
            }
            ExpressionKind::Binary(_, left, right) => {
                Self::reads(left, bindings, found);
                Self::reads(right, bindings, found);
            }
            ExpressionKind::Negate(part) => Self::reads(part, bindings, found),
            ExpressionKind::Number(_)
            | ExpressionKind::Module(_)
            | ExpressionKind::Duration
            | ExpressionKind::TotalTime => {}
        }
    }
}
