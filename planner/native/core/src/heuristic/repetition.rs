//! How often an action has to be repeated until a numeric comparison holds.

use crate::epoch::compiled::evaluate;
use crate::epoch::state::State;
use crate::pddl::model::{Assignment, Comparison};

use super::relaxed::{NumericSupport, RelaxedComparison, RelaxedTask};

/// How often an action has to be repeated to make a comparison true by itself.
pub(super) fn repetitions(
    relaxed: &RelaxedTask,
    support: &NumericSupport,
    state: &State,
) -> Option<u32> {
    let comparison = &relaxed.comparisons[support.comparison as usize];
    let (Some(assignment), Some(value)) = (support.assignment, &support.value) else {
        return Some(1);
    };
    if support.coefficient.is_nan() {
        return Some(1);
    }
    let none = &mut |_| f64::NAN;
    let value = evaluate(value, &state.values, f64::NAN, 0.0, none);
    let left = evaluate(
        &comparison.condition.left,
        &state.values,
        f64::NAN,
        0.0,
        none,
    );
    let right = evaluate(
        &comparison.condition.right,
        &state.values,
        f64::NAN,
        0.0,
        none,
    );
    let gap = left - right;
    let delta = match assignment {
        Assignment::Increase => support.coefficient * value,
        Assignment::Decrease => -support.coefficient * value,
        Assignment::Assign | Assignment::ScaleUp | Assignment::ScaleDown => return Some(1),
    };
    if delta.is_nan() || gap.is_nan() {
        return Some(1);
    }
    let rises = match comparison.condition.comparison {
        Comparison::Greater | Comparison::GreaterEqual => true,
        Comparison::Less | Comparison::LessEqual => false,
        Comparison::Equal => gap < 0.0,
    };
    if delta == 0.0 || (delta > 0.0) != rises {
        // Another effect on the way may make it useful; a last resort keeps dead ends honest.
        return (comparison.condition.comparison == Comparison::Equal && delta != 0.0)
            .then_some(1_000);
    }
    Some((gap.abs() / delta.abs()).ceil().clamp(1.0, 1e6) as u32)
}

/// Whether a comparison is known only when an action starts.
pub(super) fn undecidable(comparison: &RelaxedComparison) -> bool {
    // Attachments and `?duration` are known only when the action starts.
    use crate::task::GroundExpression as E;
    fn inside(expression: &E) -> bool {
        match expression {
            E::Duration | E::Call(_) => true,
            E::Binary(_, left, right) => inside(left) || inside(right),
            _ => false,
        }
    }
    inside(&comparison.condition.left) || inside(&comparison.condition.right)
}
