//! The goal and the metric of the task.

use crate::pddl::model::{Arithmetic, Expression, PredicateId};
use crate::task::{Axiom, Conjunction, FactId, GroundExpression, Metric};

use super::super::GroundingError;
use super::super::formula::Formula;
use super::Assembly;

impl Assembly<'_, '_> {
    pub(super) fn goal(&mut self) -> Result<(), GroundingError> {
        let world = self.world;
        // The first pass only asks for the attachments that the goal mentions.
        let mut formula = Formula::True;
        for _ in 0..2 {
            formula = self.with(None, |instantiation, bindings| {
                instantiation.condition(&world.problem.goal, true, bindings)
            });
            self.reached.costs.evaluate(world, self.limits)?;
        }
        let mut goals = self.conjunctions(formula, None)?;
        match goals.len() {
            0 => self.task.unsolvable = true,
            1 => self.task.goal = goals.remove(0),
            _ => self.disjunctive_goal(goals),
        }
        Ok(())
    }

    /// A disjunctive goal becomes a derived fact with one axiom per disjunct.
    fn disjunctive_goal(&mut self, goals: Vec<Conjunction>) {
        let head = FactId(self.task.facts.len() as u32);
        self.task.facts.push("(goal)".into());
        self.task
            .atoms
            .push((PredicateId(u32::MAX), Box::default()));
        let stratum = 1 + self
            .task
            .axioms
            .iter()
            .map(|a| a.stratum)
            .max()
            .unwrap_or(0);
        for condition in goals {
            self.task.axioms.push(Axiom {
                stratum,
                condition,
                head,
            });
        }
        self.task.goal.positive = vec![head];
    }

    pub(super) fn metric(&mut self) {
        let world = self.world;
        let Some(metric) = &world.problem.metric else {
            return;
        };
        let expression: &Expression = &metric.expression;
        let ground = self.with(None, |instantiation, bindings| {
            instantiation.expression(expression, bindings)
        });
        let Some(ground) = ground else { return };
        let makespan = matches!(slope(&ground), Some(slope) if (slope > 0.0) != metric.maximise);
        if !makespan && !matches!(ground, GroundExpression::Constant(_)) {
            self.task.metric = Some(Metric {
                maximise: metric.maximise,
                expression: ground,
            });
        }
    }
}

/// Coefficient of the makespan in an expression that depends on nothing else.
fn slope(expression: &GroundExpression) -> Option<f64> {
    match expression {
        GroundExpression::Constant(_) => Some(0.0),
        GroundExpression::TotalTime => Some(1.0),
        GroundExpression::Binary(operation, left, right) => {
            let (l, r) = (slope(left)?, slope(right)?);
            match (operation, left.as_ref(), right.as_ref()) {
                (Arithmetic::Add, ..) => Some(l + r),
                (Arithmetic::Subtract, ..) => Some(l - r),
                (Arithmetic::Multiply, GroundExpression::Constant(k), _) => Some(k * r),
                (Arithmetic::Multiply | Arithmetic::Divide, _, GroundExpression::Constant(k)) => {
                    Some(if *operation == Arithmetic::Multiply {
                        l * k
                    } else {
                        l / k
                    })
                }
                _ => None,
            }
        }
        _ => None,
    }
}
