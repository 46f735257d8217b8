//! Which comparisons a change of a fluent may make true.

use crate::pddl::model::{Assignment, Comparison};
use crate::schedule::model::{Comparing, NumericWrite};
use crate::schedule::numbering::Numbering;
use crate::schedule::propositions::{Meaning, Term};
use crate::schedule::state::State;

/// Above this many comparisons of one fluent, operators that change it alike share them.
const MANY_COMPARISONS: usize = 32;

/// Adds the numeric conditions that a change may help to make true.
pub(super) fn helped(
    numbering: &mut Numbering,
    initial: &State,
    write: &NumericWrite,
    adds: &mut Vec<Term>,
) {
    let conditions = numbering.by_fluent.get(&write.fluent.0);
    let many = conditions.is_some_and(|conditions| conditions.len() > MANY_COMPARISONS);
    let written = many.then(|| format!("{write:?}"));
    let known = written
        .as_ref()
        .and_then(|key| numbering.change_of.get(key));
    let mut term = |proposition: u32| {
        adds.push(Term {
            proposition,
            at_end: write.at_end,
            throughout: false,
        });
    };
    if let Some(known) = known {
        return term(*known);
    }
    let amount = initial.evaluate(&write.value, 1.0, &[]);
    let conditions = conditions.into_iter().flatten().copied();
    let helped: Vec<u32> = conditions
        .filter(|proposition| {
            let index = *proposition as usize - numbering.negation_of.len();
            match numbering.extra[index] {
                Meaning::Numeric(index) => {
                    let comparing = &numbering.comparisons[index as usize];
                    helps(initial, write, amount, comparing)
                }
                _ => false,
            }
        })
        .collect();
    match written {
        None => helped.into_iter().for_each(term),
        Some(written) => term(numbering.change(written, helped)),
    }
}

fn helps(initial: &State, write: &NumericWrite, amount: f64, comparing: &Comparing) -> bool {
    let change = match write.assignment {
        Assignment::Increase => amount,
        Assignment::Decrease => -amount,
        _ => return true,
    };
    let condition = &comparing.condition;
    let old = initial.fluents[write.fluent.index()].value;
    let difference = |value: f64| {
        let overlay = [(write.fluent.0, value)];
        initial.evaluate(&condition.left, 0.0, &overlay)
            - initial.evaluate(&condition.right, 0.0, &overlay)
    };
    let growth = difference(old + change) - difference(old);
    if growth.is_nan() {
        return true;
    }
    match condition.comparison {
        Comparison::Less | Comparison::LessEqual => growth < 0.0,
        Comparison::Greater | Comparison::GreaterEqual => growth > 0.0,
        Comparison::Equal => growth != 0.0,
    }
}
