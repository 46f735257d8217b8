//! The duration of a ground action from its constraints.

use crate::pddl::model::{Action, Arithmetic, Comparison, ObjectId};
use crate::task::{Duration, GroundExpression};

use super::instantiation::{Instantiation, combine};
use super::world::World;

/// The duration constraint that allows no finite time from 0 on, and its value, where static
/// fluents alone tell.
pub(super) fn impossible_duration(
    world: &World<'_>,
    action: &Action,
    bindings: &[ObjectId],
) -> Option<(usize, f64)> {
    let constraints = action.duration.iter().flatten().enumerate();
    constraints
        .filter(|(_, one)| {
            !matches!(
                one.comparison,
                Comparison::Greater | Comparison::GreaterEqual
            )
        })
        .find_map(|(index, one)| {
            let value_s = world.static_value(&one.bound, bindings)?;
            (value_s < 0.0 || !value_s.is_finite()).then_some((index, value_s))
        })
}

/// The duration of an instance, `Ok(None)` for an instantaneous action; `Err` if it has none
/// (undefined, infinite, negative, empty interval).
pub(super) fn action_duration(
    instantiation: &mut Instantiation<'_, '_>,
    action: &Action,
    bindings: &[ObjectId],
) -> Result<Option<Duration>, ()> {
    let Some(constraints) = &action.duration else {
        return Ok(None);
    };
    let mut lower: Option<GroundExpression> = None;
    let mut upper: Option<GroundExpression> = None;
    for constraint in constraints {
        let bound = instantiation
            .expression(&constraint.bound, bindings)
            .ok_or(())?;
        match constraint.comparison {
            Comparison::Equal => {
                tighten(&mut lower, bound.clone(), Arithmetic::Maximum)?;
                tighten(&mut upper, bound, Arithmetic::Minimum)?;
            }
            Comparison::Less | Comparison::LessEqual => {
                tighten(&mut upper, bound, Arithmetic::Minimum)?;
            }
            Comparison::Greater | Comparison::GreaterEqual => {
                tighten(&mut lower, bound, Arithmetic::Maximum)?;
            }
        }
    }
    let lower = lower.unwrap_or(GroundExpression::Constant(0.0));
    let upper = upper.unwrap_or(GroundExpression::Constant(f64::INFINITY));
    if let (GroundExpression::Constant(low), GroundExpression::Constant(high)) = (&lower, &upper) {
        let low = low.max(0.0);
        if low > *high {
            return Err(());
        }
        if low == *high {
            return Ok(Some(Duration::Fixed(low)));
        }
        return Ok(Some(Duration::Bounds(
            GroundExpression::Constant(low),
            upper,
        )));
    }
    Ok(Some(Duration::Bounds(lower, upper)))
}

/// Joins a further bound on the same side: all of them hold, so the tightest one counts. Which one
/// that is may depend on the state.
fn tighten(
    bound: &mut Option<GroundExpression>,
    other: GroundExpression,
    tightest: Arithmetic,
) -> Result<(), ()> {
    *bound = Some(match bound.take() {
        None => other,
        Some(known) if known == other => known,
        Some(known) => combine(tightest, known, other).ok_or(())?,
    });
    Ok(())
}
