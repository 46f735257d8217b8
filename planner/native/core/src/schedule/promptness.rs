//! Reaching goals early on average, not only the last one early.
//!
//! Where a plan covers only what is known so far, the makespan says too little: most goals may be
//! reached late without any effect on it. The flow time of scheduling counts when each job ends.

use crate::task::{Change, GroundEffect, OperatorId, Task};

/// What is added to the makespan: the mean time at which the actions that achieve the goals end [s],
/// times a weight.
#[derive(Clone, Debug)]
pub struct Promptness {
    weight: f64,
    /// Number of goal facts that each operator adds.
    achieves: Vec<u32>,
    goals: f64,
}

impl Promptness {
    /// Of a task that minimises the makespan; `None` if the weight is not positive, or if there is
    /// a metric, which counts alone.
    #[must_use]
    pub fn new(task: &Task, weight: f64) -> Option<Self> {
        if !(weight > 0.0 && weight.is_finite()) || task.metric.is_some() {
            return None;
        }
        let goal = &task.goal.positive;
        let adds = |effect: &&GroundEffect| match &effect.change {
            Change::Add(fact) => goal.contains(fact),
            _ => false,
        };
        let achieves = task.operators.iter().map(|operator| {
            let effects = operator.start_effects.iter().chain(&operator.end_effects);
            effects.filter(adds).count() as u32
        });
        Some(Self {
            weight,
            achieves: achieves.collect(),
            goals: goal.len().max(1) as f64,
        })
    }

    /// What the steps of a plan, (operator, end [s]), cost in addition to its makespan [s].
    pub fn cost(&self, steps: impl Iterator<Item = (OperatorId, f64)>) -> f64 {
        let ends = steps.map(|(operator, end)| f64::from(self.achieves[operator.index()]) * end);
        self.weight * ends.sum::<f64>() / self.goals
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::testing::{FACTORY, operator, task};

    #[test]
    fn ends_of_the_achievers_count() {
        let task = task(FACTORY);
        let promptness = Promptness::new(&task, 2.0).unwrap_or_else(|| panic!("a weight"));
        let steps =
            ["prime", "paint", "pack", "sweep"].map(|name| OperatorId(operator(&task, name)));
        let ends = [4.0, 7.0, 6.0, 1.0];
        // Goals: packed at 6, swept at 7, clean at 1; priming achieves none of them.
        let cost = promptness.cost(steps.into_iter().zip(ends));
        assert!(
            (cost - 2.0 * (6.0 + 7.0 + 1.0) / 3.0).abs() < 1e-9,
            "{cost}"
        );
    }

    #[test]
    fn without_weight_there_is_none() {
        let task = task(FACTORY);
        assert!(Promptness::new(&task, 0.0).is_none());
        assert!(Promptness::new(&task, f64::NAN).is_none());
    }
}
