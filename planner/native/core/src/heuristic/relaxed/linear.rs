//! Linear forms of numeric expressions.

use crate::pddl::model::Arithmetic;
use crate::task::{FluentId, GroundExpression, NumericCondition};

/// Adds `factor * expression` to a linear form; false if it is not linear.
pub(super) fn linear(
    expression: &GroundExpression,
    factor: f64,
    form: &mut Vec<(FluentId, f64)>,
) -> bool {
    match expression {
        GroundExpression::Constant(_) => true,
        GroundExpression::Fluent(fluent) => {
            form.push((*fluent, factor));
            true
        }
        GroundExpression::Binary(Arithmetic::Add, left, right) => {
            linear(left, factor, form) && linear(right, factor, form)
        }
        GroundExpression::Binary(Arithmetic::Subtract, left, right) => {
            linear(left, factor, form) && linear(right, -factor, form)
        }
        GroundExpression::Binary(Arithmetic::Multiply, left, right) => {
            match (left.as_ref(), right.as_ref()) {
                (GroundExpression::Constant(k), other) | (other, GroundExpression::Constant(k)) => {
                    linear(other, factor * k, form)
                }
                _ => false,
            }
        }
        GroundExpression::Binary(Arithmetic::Divide, left, right) => match right.as_ref() {
            GroundExpression::Constant(k) => linear(left, factor / k, form),
            _ => false,
        },
        GroundExpression::Binary(Arithmetic::Minimum | Arithmetic::Maximum, ..)
        | GroundExpression::Duration
        | GroundExpression::TotalTime
        | GroundExpression::Call(_) => false,
    }
}

pub(super) fn mentions(condition: &NumericCondition, fluent: FluentId) -> bool {
    fn inside(expression: &GroundExpression, fluent: FluentId) -> bool {
        match expression {
            GroundExpression::Fluent(other) => *other == fluent,
            GroundExpression::Binary(_, left, right) => {
                inside(left, fluent) || inside(right, fluent)
            }
            GroundExpression::Call(_) => true,
            _ => false,
        }
    }
    inside(&condition.left, fluent) || inside(&condition.right, fluent)
}
