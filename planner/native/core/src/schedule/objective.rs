//! What the schemes minimise.

use crate::pddl::model::Arithmetic;
use crate::schedule::model::{Model, fluents_of};
use crate::schedule::promptness::Promptness;
use crate::schedule::state::State;
use crate::task::{GroundExpression, OperatorId, Task};

/// Weight of the mean goal time: leads the search where the makespan is flat.
const MEAN_GOAL_WEIGHT: f64 = 0.05;

/// The makespan, perhaps with a share of the mean goal time, or the task's metric.
#[derive(Clone, Debug)]
pub struct Objective {
    metric: Option<(f64, GroundExpression)>,
    promptness: Option<Promptness>,
}

impl Objective {
    /// Reads the task's metric; `None` if it calls an attachment.
    pub fn new(task: &Task, promptness: Option<Promptness>) -> Option<Self> {
        let metric = match &task.metric {
            None => None,
            Some(metric) if !metric.maximise && is_total_time(&metric.expression) => None,
            Some(metric) => {
                fluents_of(&metric.expression, &mut Vec::new())?;
                let sign = if metric.maximise { -1.0 } else { 1.0 };
                Some((sign, metric.expression.clone()))
            }
        };
        Some(Self { metric, promptness })
    }

    /// Whether time is what counts: no plan is worth less than its makespan.
    pub fn is_time(&self) -> bool {
        self.metric.is_none()
    }

    /// Whether the makespan is all that counts.
    pub fn is_makespan(&self) -> bool {
        self.metric.is_none() && self.promptness.is_none()
    }

    /// What has to become small: the makespan, or the metric (negated to maximise).
    pub fn primary(&self, state: &State) -> f64 {
        match &self.metric {
            None => state.makespan + self.tardiness(state),
            Some((sign, expression)) => sign * state.evaluate(expression, 0.0, &[]),
        }
    }

    fn tardiness(&self, state: &State) -> f64 {
        let Some(promptness) = &self.promptness else {
            return 0.0;
        };
        let steps = state.list.iter();
        promptness.cost(steps.map(|step| (OperatorId(step.operator), step.end())))
    }

    /// The primary value with a small share of what leads to it.
    pub fn value(&self, model: &Model, state: &State) -> f64 {
        let mut sum = 0.0;
        for (fact, _) in &model.goal {
            sum += state.facts[*fact as usize].changed.max(0.0);
        }
        let mean = sum / model.goal.len().max(1) as f64;
        let primary = self.primary(state);
        match self.metric {
            None => primary + MEAN_GOAL_WEIGHT * mean,
            Some(_) => primary + 1e-5 * (state.makespan + MEAN_GOAL_WEIGHT * mean),
        }
    }

    /// Cost of each operator for the relaxation: its duration, or what it adds to the metric.
    pub fn operator_costs(&self, model: &Model, initial: &State) -> Vec<f32> {
        let costs = (0..model.shapes.len() as u32).map(|operator| {
            let shape = &model.shapes[operator as usize];
            let duration = if shape.duration.is_nan() {
                1.0
            } else {
                shape.duration
            };
            let Some((sign, expression)) = &self.metric else {
                return duration as f32;
            };
            let mut overlay = Vec::new();
            let before = initial.evaluate(expression, duration, &overlay);
            if let Some(detail) = model.detail(operator) {
                for write in &detail.numeric {
                    let old = initial.fluents[write.fluent.index()].value;
                    let amount = initial.evaluate(&write.value, duration, &[]);
                    overlay.push((
                        write.fluent.0,
                        crate::schedule::state::combine(write.assignment, old, amount),
                    ));
                }
            }
            let after = initial.evaluate(expression, duration, &overlay);
            let cost = sign * (after - before);
            (if cost.is_finite() { cost.max(0.0) } else { 0.0 } + 1e-4 * duration) as f32
        });
        costs.collect()
    }
}

fn is_total_time(expression: &GroundExpression) -> bool {
    match expression {
        GroundExpression::TotalTime => true,
        GroundExpression::Binary(Arithmetic::Multiply, left, right) => {
            matches!((&**left, &**right), (GroundExpression::Constant(factor), time)
                | (time, GroundExpression::Constant(factor))
                if *factor > 0.0 && is_total_time(time))
        }
        _ => false,
    }
}
