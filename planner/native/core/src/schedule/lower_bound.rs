//! A lower bound on the makespan of every plan: the critical path of the delete relaxation
//! (h_max with durations; Haslum and Geffner, "Heuristic planning with time and resources", 2001).
//!
//! A start effect counts from the start of its operator, but a goal is reached no sooner than at
//! the end of an operator that adds it, because the plan lasts until then.

use crate::schedule::model::{EPSILON, Model, NONE};
use crate::schedule::propositions::{Meaning, Propositions, Rule, Term};
use crate::schedule::state::State;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Least makespan of any plan that reaches each goal [s]; infinite if the relaxation has none.
pub fn goal_bounds(model: &Model, propositions: &Propositions, initial: &State) -> Vec<f64> {
    let count = propositions.count();
    let mut label = vec![f64::INFINITY; count];
    let mut settled = vec![false; count];
    let mut finished = vec![f64::INFINITY; count];
    let mut queue = BinaryHeap::new();
    for proposition in 0..count as u32 {
        let open = if proposition < propositions.fact_count {
            model.initial_facts[proposition as usize]
                || model.window_of[proposition as usize] != NONE
        } else {
            // Numeric conditions may be reached in ways the rules do not show.
            match propositions.extra[(proposition - propositions.fact_count) as usize] {
                Meaning::Literal(fact, _) => {
                    !model.initial_facts[fact as usize] || model.window_of[fact as usize] != NONE
                }
                Meaning::Lasting(..) | Meaning::Numeric(_) | Meaning::Change => true,
            }
        };
        if open {
            label[proposition as usize] = if model_window(model, propositions, proposition) {
                // Timed literals: true from the first moment that the state knows of.
                let holds = propositions.holds(initial, proposition);
                let time = propositions.time(model, initial, proposition);
                if holds && time.is_finite() {
                    0.0f64.min(time)
                } else {
                    time
                }
            } else {
                0.0
            };
            if label[proposition as usize].is_finite() {
                queue.push(Reverse((
                    label[proposition as usize].to_bits(),
                    proposition,
                )));
            }
        }
    }
    let mut fire =
        |rule_index: usize, label: &mut Vec<f64>, queue: &mut BinaryHeap<Reverse<(u64, u32)>>| {
            let rule = &propositions.rules[rule_index];
            if rule.operator == NONE {
                return; // numeric, and so open from the beginning
            }
            let shape = &model.shapes[rule.operator as usize];
            // A duration that depends on the state may be anything.
            let duration = if shape.duration.is_nan() {
                0.0
            } else {
                shape.duration
            };
            let mut start = 0.0f64;
            for need in propositions.needs(rule) {
                if !counts(propositions, rule, need) {
                    continue;
                }
                let time = label[need.proposition as usize];
                let lag = if need.at_end { duration } else { 0.0 };
                // What an operator had to change can be read, but not hold throughout, only later.
                let apart = if time > 0.0 && !need.throughout {
                    EPSILON
                } else {
                    0.0
                };
                start = start.max(time + apart - lag);
            }
            for add in propositions.adds(rule) {
                let time = start + if add.at_end { duration } else { 0.0 };
                let index = add.proposition as usize;
                finished[index] = finished[index].min(start + duration);
                if time < label[index] {
                    label[index] = time;
                    queue.push(Reverse((time.to_bits(), add.proposition)));
                }
            }
        };
    let ready = |rule: &Rule, settled: &[bool]| {
        let mut needs = propositions.needs(rule).iter();
        needs.all(|need| settled[need.proposition as usize] || !counts(propositions, rule, need))
    };
    for (index, rule) in propositions.rules.iter().enumerate() {
        if ready(rule, &settled) {
            fire(index, &mut label, &mut queue);
        }
    }
    while let Some(Reverse((_, proposition))) = queue.pop() {
        if std::mem::replace(&mut settled[proposition as usize], true) {
            continue;
        }
        for index in propositions.needing.row(proposition) {
            if ready(&propositions.rules[*index as usize], &settled) {
                fire(*index as usize, &mut label, &mut queue);
            }
        }
    }
    let goals = propositions.goal.iter().map(|goal| {
        let index = *goal as usize;
        let exogenous = model_window(model, propositions, *goal);
        let numeric = propositions.literal(*goal).is_none();
        // How much a numeric goal needs, the rules do not show.
        if propositions.holds(initial, *goal) || exogenous || numeric {
            0.0
        } else {
            finished[index]
        }
    });
    goals.collect()
}

/// Whether a need delays a rule in the bound: needs at the end do not delay start effects.
fn counts(propositions: &Propositions, rule: &Rule, need: &Term) -> bool {
    !need.at_end || propositions.adds(rule).iter().all(|add| add.at_end)
}

fn model_window(model: &Model, propositions: &Propositions, proposition: u32) -> bool {
    propositions
        .literal(proposition)
        .is_some_and(|(fact, _)| model.window_of[fact as usize] != NONE)
}

#[cfg(test)]
mod tests {
    use super::goal_bounds;
    use crate::schedule::testing::{FACTORY, task};
    use crate::schedule::workshop::Workshop;

    #[test]
    fn start_effects_count_from_the_start_but_goals_last_to_the_end() {
        let task = task(FACTORY);
        let workshop = Workshop::new(&task, 0, None).expect("supported");
        let bounds = goal_bounds(&workshop.model, &workshop.propositions, &workshop.state);
        // prime: [0, 4], adds primed at its end; paint starts 0.001 later, adds painted at its
        // start and lasts 3; pack reads painted 0.001 after that and lasts 2.
        let mut bounds = bounds;
        bounds.sort_by(f64::total_cmp);
        let expected = [1.0, 6.002, 7.001];
        assert_eq!(bounds.len(), expected.len());
        for (bound, expected) in bounds.iter().zip(expected) {
            assert!((bound - expected).abs() < 1e-9, "{bounds:?}");
        }
    }
}
