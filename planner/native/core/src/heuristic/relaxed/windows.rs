//! Facts that hold for a while only because an operator that opens a window closes it at its end.

use crate::task::{Change, Duration, FactId, Operator, Task};

/// Facts that an operator's end deletes and another operator needs throughout, sorted, with the
/// lengths of the windows in which they hold, sorted; the last one is infinite.
pub(super) fn windows(task: &Task) -> Vec<(FactId, Vec<f64>)> {
    let mut needed = vec![false; task.facts.len()];
    for operator in &task.operators {
        for fact in &operator.invariant.positive {
            needed[fact.index()] = true;
        }
    }
    let mut windows: std::collections::BTreeMap<FactId, Vec<f64>> = Default::default();
    for operator in &task.operators {
        for effect in &operator.end_effects {
            if let (None, Change::Delete(fact)) = (&effect.condition, &effect.change)
                && needed[fact.index()]
            {
                let lengths = windows.entry(*fact).or_insert_with(|| vec![f64::INFINITY]);
                let opens = operator
                    .start_effects
                    .iter()
                    .any(|effect| effect.change == Change::Add(*fact));
                if let (true, Some(Duration::Fixed(seconds))) = (opens, &operator.duration) {
                    lengths.push(*seconds);
                }
            }
        }
    }
    windows
        .into_iter()
        .map(|(fact, mut lengths)| {
            lengths.sort_by(f64::total_cmp);
            lengths.dedup();
            (fact, lengths)
        })
        .collect()
}

pub(super) fn deletes_at_end(operator: &Operator, fact: FactId) -> bool {
    operator
        .end_effects
        .iter()
        .any(|effect| effect.condition.is_none() && effect.change == Change::Delete(fact))
}
