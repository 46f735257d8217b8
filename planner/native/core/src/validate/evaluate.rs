//! Truth of conditions and values of expressions in a state, by substitution.

use super::scene::{Fault, Moment, Scene};
use crate::attachment::StateView as _;
use crate::pddl::model::{
    Arithmetic, Comparison, Condition, ConditionKind, Expression, ExpressionKind, ObjectId,
    Parameter,
};

/// Two numbers closer than this, relative to the larger one, are equal: what sums and products
/// of decimal fractions lose in binary.
const ROUNDING: f64 = 1e-9;

/// Compares two numbers; differences within rounding count as equality.
pub(super) fn compare(comparison: Comparison, left: f64, right: f64) -> bool {
    let scale = left.abs().max(right.abs()).max(1.0);
    #[allow(clippy::float_cmp)] // infinities are equal only to themselves
    let equal = left == right || (scale.is_finite() && (left - right).abs() <= ROUNDING * scale);
    match comparison {
        Comparison::Less => left < right && !equal,
        Comparison::LessEqual => left < right || equal,
        Comparison::Equal => equal,
        Comparison::GreaterEqual => left > right || equal,
        Comparison::Greater => left > right && !equal,
    }
}

impl Scene<'_> {
    /// Whether a condition holds; `bindings` is the stack of bound variables.
    pub(super) fn holds(
        &self,
        moment: &Moment<'_>,
        condition: &Condition,
        bindings: &mut Vec<ObjectId>,
    ) -> Result<bool, Fault> {
        match &condition.kind {
            ConditionKind::And(parts) => {
                for part in parts {
                    if !self.holds(moment, part, bindings)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
            ConditionKind::Or(parts) => {
                for part in parts {
                    if self.holds(moment, part, bindings)? {
                        return Ok(true);
                    }
                }
                Ok(false)
            }
            ConditionKind::Not(part) => Ok(!self.holds(moment, part, bindings)?),
            ConditionKind::Imply(premise, conclusion) => Ok(!self
                .holds(moment, premise, bindings)?
                || self.holds(moment, conclusion, bindings)?),
            ConditionKind::Forall(parameters, part) => {
                let exception = self.instance(parameters, bindings, &mut |bindings| {
                    Ok(!self.holds(moment, part, bindings)?)
                })?;
                Ok(exception.is_none())
            }
            ConditionKind::Exists(parameters, part) => {
                let witness = self.instance(parameters, bindings, &mut |bindings| {
                    self.holds(moment, part, bindings)
                })?;
                Ok(witness.is_some())
            }
            ConditionKind::Atom(atom) => Ok(moment
                .state
                .holds(atom.predicate, &Self::tuple(&atom.arguments, bindings))),
            ConditionKind::Equal(left, right) => {
                Ok(Self::object(*left, bindings) == Self::object(*right, bindings))
            }
            ConditionKind::Compare(comparison, left, right) => Ok(compare(
                *comparison,
                self.value(moment, left, bindings)?,
                self.value(moment, right, bindings)?,
            )),
            ConditionKind::Module(call) => {
                // The ancestor's convention: a condition checker says no with 0 or with infinity.
                let value = self.call(call, bindings, moment)?;
                Ok(value != 0.0 && value.is_finite())
            }
        }
    }

    /// The first binding of the parameters, in order of declaration, for which the test is true;
    /// the whole stack of bindings is returned.
    pub(super) fn instance(
        &self,
        parameters: &[Parameter],
        bindings: &mut Vec<ObjectId>,
        test: &mut dyn FnMut(&mut Vec<ObjectId>) -> Result<bool, Fault>,
    ) -> Result<Option<Vec<ObjectId>>, Fault> {
        let Some((first, rest)) = parameters.split_first() else {
            return Ok(test(bindings)?.then(|| bindings.clone()));
        };
        for object in self.types.objects_of(first) {
            bindings.push(object);
            let found = self.instance(rest, bindings, test);
            bindings.pop();
            if let Some(stack) = found? {
                return Ok(Some(stack));
            }
        }
        Ok(None)
    }

    /// The value of an expression.
    pub(super) fn value(
        &self,
        moment: &Moment<'_>,
        expression: &Expression,
        bindings: &[ObjectId],
    ) -> Result<f64, Fault> {
        let text = || self.expression_text(expression, bindings);
        let value = match &expression.kind {
            ExpressionKind::Number(number) => *number,
            ExpressionKind::Fluent(term) => moment
                .state
                .value(term.function, &Self::tuple(&term.arguments, bindings))
                .ok_or_else(|| Fault::Undefined(text()))?,
            ExpressionKind::Module(call) => self.call(call, bindings, moment)?,
            ExpressionKind::Duration => moment.duration.ok_or_else(|| Fault::Undefined(text()))?,
            ExpressionKind::TotalTime => moment.total_time,
            ExpressionKind::Binary(operation, left, right) => {
                let left = self.value(moment, left, bindings)?;
                let right = self.value(moment, right, bindings)?;
                match operation {
                    Arithmetic::Add => left + right,
                    Arithmetic::Subtract => left - right,
                    Arithmetic::Multiply => left * right,
                    Arithmetic::Divide if right == 0.0 => {
                        return Err(Fault::NotANumber(text()));
                    }
                    Arithmetic::Divide => left / right,
                    Arithmetic::Minimum => left.min(right),
                    Arithmetic::Maximum => left.max(right),
                }
            }
            ExpressionKind::Negate(part) => -self.value(moment, part, bindings)?,
        };
        if value.is_nan() {
            return Err(Fault::NotANumber(text()));
        }
        Ok(value)
    }
}

#[cfg(test)]
mod tests {
    use super::compare;
    use crate::pddl::model::Comparison;

    #[test]
    fn rounding_is_equality() {
        assert!(compare(Comparison::Equal, 0.1 + 0.2, 0.3));
        assert!(compare(Comparison::GreaterEqual, 0.3, 0.1 + 0.2));
        assert!(!compare(Comparison::Greater, 0.1 + 0.2, 0.3));
        assert!(!compare(Comparison::Less, 1.0, 1.0));
        assert!(compare(Comparison::Less, 1.0, 1.000_001));
    }

    #[test]
    fn infinity_is_larger_than_any_number() {
        assert!(compare(Comparison::Less, 1e300, f64::INFINITY));
        assert!(compare(Comparison::Equal, f64::INFINITY, f64::INFINITY));
        assert!(!compare(Comparison::GreaterEqual, 5.0, f64::INFINITY));
    }
}
