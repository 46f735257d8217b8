//! Conditions as bit tests, comparisons and expressions over a state's numbers.

use crate::pddl::model::Comparison;
use crate::task::{CallId, Conjunction, FactId, GroundExpression, NumericCondition};

/// A conjunction as masks over the words of a fact set that it touches.
#[derive(Clone, Debug, Default)]
pub struct Condition {
    /// `(word, bits that must be one, bits that must be zero)`.
    masks: Vec<(u32, u64, u64)>,
    /// Numeric comparisons.
    pub comparisons: Vec<NumericCondition>,
    /// State-dependent condition attachments.
    pub calls: Vec<(CallId, bool)>,
}

impl Condition {
    /// Compiles a conjunction.
    #[must_use]
    pub fn new(conjunction: &Conjunction) -> Self {
        let mut masks: Vec<(u32, u64, u64)> = Vec::new();
        let mut mark = |fact: FactId, positive: bool| {
            let (word, bit) = (fact.0 / 64, 1_u64 << (fact.0 % 64));
            let position = masks.iter().position(|mask| mask.0 == word);
            let position = position.unwrap_or_else(|| {
                masks.push((word, 0, 0));
                masks.len() - 1
            });
            if positive {
                masks[position].1 |= bit;
            } else {
                masks[position].2 |= bit;
            }
        };
        conjunction.positive.iter().for_each(|&f| mark(f, true));
        conjunction.negative.iter().for_each(|&f| mark(f, false));
        Self {
            masks,
            comparisons: conjunction.comparisons.clone(),
            calls: conjunction.calls.clone(),
        }
    }

    /// Whether it is trivially true.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.masks.is_empty() && self.comparisons.is_empty() && self.calls.is_empty()
    }

    /// Whether the literals hold in a fact set.
    #[inline]
    #[must_use]
    pub fn literals_hold(&self, facts: &[u64]) -> bool {
        self.masks.iter().all(|&(word, ones, zeros)| {
            let bits = facts[word as usize];
            bits & ones == ones && bits & zeros == 0
        })
    }
}

/// The value of an expression; NaN where it is undefined. `call` supplies attachments.
pub fn evaluate(
    expression: &GroundExpression,
    values: &[f64],
    duration: f64,
    total_time: f64,
    call: &mut dyn FnMut(CallId) -> f64,
) -> f64 {
    match expression {
        GroundExpression::Constant(value) => *value,
        GroundExpression::Fluent(fluent) => values[fluent.index()],
        GroundExpression::Duration => duration,
        GroundExpression::TotalTime => total_time,
        GroundExpression::Call(id) => call(*id),
        GroundExpression::Binary(operation, left, right) => {
            let left = evaluate(left, values, duration, total_time, call);
            let right = evaluate(right, values, duration, total_time, call);
            operation.apply(left, right)
        }
    }
}

/// Whether a comparison holds; false where a side is undefined.
pub fn comparison_holds(
    condition: &NumericCondition,
    values: &[f64],
    duration: f64,
    call: &mut dyn FnMut(CallId) -> f64,
) -> bool {
    let left = evaluate(&condition.left, values, duration, 0.0, call);
    let right = evaluate(&condition.right, values, duration, 0.0, call);
    let comparison: Comparison = condition.comparison;
    comparison.holds(left, right)
}
