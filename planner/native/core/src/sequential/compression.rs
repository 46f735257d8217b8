//! The classical task behind a temporal one.

use crate::pddl::model::Assignment;
use crate::task::{
    Change, Conjunction, Duration, FactId, FluentId, GroundEffect, GroundExpression,
    NumericCondition, Operator, Task,
};

/// A task with the same operators, each done at once. `None` where that says little about the
/// task: with timed literals, attachments that look at the state, or durations that depend on it.
///
/// A plan of the compressed task need not be one of the task itself (a condition that the
/// operator's own start effects decide is left out): see [`super::timing`].
#[must_use]
pub fn compress(task: &Task) -> Option<Task> {
    if !task.timed.is_empty() || !task.calls.is_empty() {
        return None;
    }
    let operators = task.operators.iter().map(compress_operator);
    Some(Task {
        operators: operators.collect::<Option<Vec<_>>>()?,
        action_names: task.action_names.clone(),
        object_names: task.object_names.clone(),
        facts: task.facts.clone(),
        atoms: task.atoms.clone(),
        fluents: task.fluents.clone(),
        initial_facts: task.initial_facts.clone(),
        initial_values: task.initial_values.clone(),
        axioms: task.axioms.clone(),
        goal: task.goal.clone(),
        mutex_groups: task.mutex_groups.clone(),
        narrowed: true,
        ..Task::default()
    })
}

fn compress_operator(operator: &Operator) -> Option<Operator> {
    let duration = match &operator.duration {
        None => return Some(operator.clone()),
        Some(Duration::Fixed(seconds)) => *seconds,
        Some(Duration::Bounds(GroundExpression::Constant(seconds), _)) => *seconds,
        Some(Duration::Bounds(..)) => return None,
    };
    let mut condition = operator.start_condition.clone();
    for later in [&operator.invariant, &operator.end_condition] {
        join(&mut condition, later, &operator.start_effects, duration);
    }
    for list in [&mut condition.positive, &mut condition.negative] {
        list.sort_unstable();
        list.dedup();
    }
    let mut effects = Vec::new();
    let mut written: Vec<(FluentId, bool)> = Vec::new();
    for (effect, at_end) in operator
        .start_effects
        .iter()
        .map(|effect| (effect, false))
        .chain(operator.end_effects.iter().map(|effect| (effect, true)))
    {
        if !at_end && overwritten(effect, &operator.end_effects) {
            continue;
        }
        let change = match &effect.change {
            Change::Assign(assignment, fluent, value) => {
                let additive = matches!(assignment, Assignment::Increase | Assignment::Decrease);
                if written.iter().any(|w| w.0 == *fluent && !(w.1 && additive)) {
                    return None;
                }
                written.push((*fluent, additive));
                Change::Assign(*assignment, *fluent, with_duration(value, duration))
            }
            Change::Call(_) => return None,
            literal => literal.clone(),
        };
        // What holds before and afterwards is only locked in between.
        if effect.condition.is_none()
            && (matches!(change, Change::Add(fact) if condition.positive.contains(&fact))
                || matches!(change, Change::Delete(fact) if condition.negative.contains(&fact)))
        {
            continue;
        }
        effects.push(GroundEffect {
            condition: effect.condition.as_ref().map(|parts| {
                let mut whole = parts[0].clone();
                for part in &parts[1..] {
                    join(&mut whole, part, &[], duration);
                }
                Box::new([whole, Conjunction::default(), Conjunction::default()])
            }),
            change,
        });
    }
    Some(Operator {
        action: operator.action,
        arguments: operator.arguments.clone(),
        duration: None,
        start_condition: condition,
        invariant: Conjunction::default(),
        end_condition: Conjunction::default(),
        also_reads: [Vec::new(), Vec::new()],
        start_effects: effects,
        end_effects: Vec::new(),
    })
}

/// Adds a later condition, without what the operator's own start effects decide.
fn join(condition: &mut Conjunction, later: &Conjunction, start: &[GroundEffect], duration: f64) {
    let own = |fact: &FactId| {
        start.iter().any(|effect| {
            matches!(&effect.change, Change::Add(other) | Change::Delete(other) if other == fact)
        })
    };
    let foreign = |facts: &[FactId]| {
        let facts = facts.iter().copied().filter(|fact| !own(fact));
        facts.collect::<Vec<_>>()
    };
    condition.positive.extend(foreign(&later.positive));
    condition.negative.extend(foreign(&later.negative));
    for comparison in &later.comparisons {
        let changed = start.iter().any(|effect| {
            matches!(&effect.change, Change::Assign(_, fluent, _)
                if mentions(&comparison.left, *fluent) || mentions(&comparison.right, *fluent))
        });
        if !changed {
            condition.comparisons.push(NumericCondition {
                comparison: comparison.comparison,
                left: with_duration(&comparison.left, duration),
                right: with_duration(&comparison.right, duration),
            });
        }
    }
}

/// Whether an effect at the end gives the same fact its value in any case.
fn overwritten(effect: &GroundEffect, end: &[GroundEffect]) -> bool {
    let (Change::Add(fact) | Change::Delete(fact)) = &effect.change else {
        return false;
    };
    end.iter().any(|later| {
        later.condition.is_none()
            && matches!(&later.change, Change::Add(other) | Change::Delete(other) if other == fact)
    })
}

fn mentions(expression: &GroundExpression, fluent: FluentId) -> bool {
    match expression {
        GroundExpression::Fluent(other) => *other == fluent,
        GroundExpression::Binary(_, left, right) => {
            mentions(left, fluent) || mentions(right, fluent)
        }
        _ => false,
    }
}

fn with_duration(expression: &GroundExpression, duration: f64) -> GroundExpression {
    match expression {
        GroundExpression::Duration => GroundExpression::Constant(duration),
        GroundExpression::Binary(operation, left, right) => GroundExpression::Binary(
            *operation,
            Box::new(with_duration(left, duration)),
            Box::new(with_duration(right, duration)),
        ),
        other => other.clone(),
    }
}
