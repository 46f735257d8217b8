//! What exhausting the decision-epoch space proves about a task.

use std::collections::HashSet;

use crate::pddl::model::{Assignment, Comparison};
use crate::task::{
    Change, Conjunction, Duration, FactId, FluentId, GroundEffect, GroundExpression, Operator, Task,
};

/// Properties of a task, found by looking at its operators.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Completeness {
    /// Every solvable task of this form has a plan in the space.
    pub finds_plans: bool,
    /// A shortest plan is in the space, so that exhausting it proves optimality.
    pub keeps_optima: bool,
    /// Ending earlier is never a disadvantage, so that earlier states dominate.
    pub earlier_is_better: bool,
    /// Some plan may need an action to start inside another one.
    pub required_concurrency: bool,
}

/// Analyses a task.
///
/// An end happening is *harmless* if nothing needs it to come late: it deletes no fact that a
/// condition or the goal reads positively, adds none that one reads negatively, and changes
/// numbers only in a direction that makes every comparison on them easier; and its own condition
/// is already implied while the operator runs. If all ends are harmless, shifting any action of a
/// plan to the left until it starts at an event keeps the plan valid, hence a shortest plan
/// starts actions at events only.
#[must_use]
pub fn analyse(task: &Task) -> Completeness {
    let readers = Readers::new(task);
    let timeless = task.timed.is_empty();
    let opaque = !task.calls.is_empty();
    let fixed = task
        .operators
        .iter()
        .all(|operator| !matches!(operator.duration, Some(Duration::Bounds(..))));
    let harmless = task
        .operators
        .iter()
        .all(|operator| readers.harmless(operator));
    let required_concurrency = required_concurrency(task);
    let whole = !task.narrowed && !task.partial;
    let plain = !opaque && fixed && whole && task.axioms.is_empty();
    Completeness {
        finds_plans: plain && timeless && !required_concurrency && readers.sequential(task),
        keeps_optima: plain && timeless && harmless && task.metric.is_none(),
        earlier_is_better: plain && timeless && harmless,
        required_concurrency,
    }
}

/// Facts that an operator makes true only while it runs and that others rely on.
fn required_concurrency(task: &Task) -> bool {
    let mut fleeting: HashSet<FactId> = HashSet::new();
    for operator in &task.operators {
        for effect in &operator.start_effects {
            if let Change::Add(fact) = effect.change
                && deletes(&operator.end_effects, fact)
            {
                fleeting.insert(fact);
            }
        }
    }
    // A fact that another operator supplies for good is not bound to a window.
    for operator in &task.operators {
        for (own, later) in [
            (&operator.start_effects, &operator.end_effects),
            (&operator.end_effects, &operator.end_effects),
        ] {
            for effect in own {
                if let Change::Add(fact) = effect.change
                    && !deletes(later, fact)
                {
                    fleeting.remove(&fact);
                }
            }
        }
    }
    !fleeting.is_empty()
        && task.operators.iter().any(|operator| {
            [
                &operator.start_condition,
                &operator.invariant,
                &operator.end_condition,
            ]
            .into_iter()
            .flat_map(|condition| &condition.positive)
            .any(|fact| fleeting.contains(fact) && !adds(&operator.start_effects, *fact))
        })
}

fn deletes(effects: &[GroundEffect], fact: FactId) -> bool {
    effects
        .iter()
        .any(|effect| effect.change == Change::Delete(fact))
}

fn adds(effects: &[GroundEffect], fact: FactId) -> bool {
    effects
        .iter()
        .any(|effect| effect.change == Change::Add(fact))
}

/// Who reads what, with which sign.
struct Readers {
    positive: HashSet<FactId>,
    negative: HashSet<FactId>,
    /// Fluents that may only rise (`true`) or fall (`false`) without making a comparison harder.
    grows: HashSet<FluentId>,
    shrinks: HashSet<FluentId>,
}

impl Readers {
    fn new(task: &Task) -> Self {
        let mut readers = Self {
            positive: HashSet::new(),
            negative: HashSet::new(),
            grows: HashSet::new(),
            shrinks: HashSet::new(),
        };
        readers.conjunction(&task.goal);
        for axiom in &task.axioms {
            readers.conjunction(&axiom.condition);
        }
        for operator in &task.operators {
            for condition in [
                &operator.start_condition,
                &operator.invariant,
                &operator.end_condition,
            ] {
                readers.conjunction(condition);
            }
            for effect in operator.start_effects.iter().chain(&operator.end_effects) {
                if let Some(conditions) = &effect.condition {
                    for condition in conditions.iter() {
                        readers.conjunction(condition);
                        for fact in &condition.positive {
                            readers.negative.insert(*fact);
                        }
                        for fact in &condition.negative {
                            readers.positive.insert(*fact);
                        }
                        for comparison in &condition.comparisons {
                            readers.both(&comparison.left);
                            readers.both(&comparison.right);
                        }
                    }
                }
                if let Change::Assign(_, _, value) = &effect.change {
                    readers.both(value);
                }
            }
            if let Some(Duration::Bounds(lower, upper)) = &operator.duration {
                readers.both(lower);
                readers.both(upper);
            }
        }
        readers
    }

    fn conjunction(&mut self, conjunction: &Conjunction) {
        self.positive.extend(&conjunction.positive);
        self.negative.extend(&conjunction.negative);
        for comparison in &conjunction.comparisons {
            match comparison.comparison {
                Comparison::Less | Comparison::LessEqual => {
                    self.signed(&comparison.left, false);
                    self.signed(&comparison.right, true);
                }
                Comparison::Greater | Comparison::GreaterEqual => {
                    self.signed(&comparison.left, true);
                    self.signed(&comparison.right, false);
                }
                Comparison::Equal => {
                    self.both(&comparison.left);
                    self.both(&comparison.right);
                }
            }
        }
    }

    /// Notes that more (`helps`) or less of an expression makes a comparison easier.
    fn signed(&mut self, expression: &GroundExpression, helps: bool) {
        use crate::pddl::model::Arithmetic::{Add, Subtract};
        match expression {
            GroundExpression::Fluent(fluent) => {
                if helps {
                    self.grows.insert(*fluent);
                } else {
                    self.shrinks.insert(*fluent);
                }
            }
            GroundExpression::Binary(Add, left, right) => {
                self.signed(left, helps);
                self.signed(right, helps);
            }
            GroundExpression::Binary(Subtract, left, right) => {
                self.signed(left, helps);
                self.signed(right, !helps);
            }
            other => self.both(other),
        }
    }

    fn both(&mut self, expression: &GroundExpression) {
        match expression {
            GroundExpression::Fluent(fluent) => {
                self.grows.insert(*fluent);
                self.shrinks.insert(*fluent);
            }
            GroundExpression::Binary(_, left, right) => {
                self.both(left);
                self.both(right);
            }
            _ => {}
        }
    }

    fn harmless(&self, operator: &Operator) -> bool {
        let implied = |condition: &Conjunction| {
            condition.comparisons.is_empty()
                && condition.calls.is_empty()
                && condition
                    .positive
                    .iter()
                    .all(|fact| operator.invariant.positive.contains(fact))
                && condition
                    .negative
                    .iter()
                    .all(|fact| operator.invariant.negative.contains(fact))
        };
        implied(&operator.end_condition)
            && operator.end_effects.iter().all(|effect| {
                effect.condition.is_none()
                    && match &effect.change {
                        Change::Add(fact) => !self.negative.contains(fact),
                        Change::Delete(fact) => !self.positive.contains(fact),
                        Change::Assign(assignment, fluent, GroundExpression::Constant(value)) => {
                            let rises = match assignment {
                                Assignment::Increase => *value >= 0.0,
                                Assignment::Decrease => *value <= 0.0,
                                _ => return false,
                            };
                            if rises {
                                !self.shrinks.contains(fluent)
                            } else {
                                !self.grows.contains(fluent)
                            }
                        }
                        Change::Assign(..) | Change::Call(_) => false,
                    }
            })
    }

    /// Whether any plan can be run one action after the other: each operator is as good as an
    /// instantaneous one that does everything at its start and end together.
    fn sequential(&self, task: &Task) -> bool {
        task.operators.iter().all(|operator| {
            let Some(_) = operator.duration else {
                return true;
            };
            // What others could supply or take away while it runs must not matter: conditions
            // after the start have to hold at the start already, and what it gives up at its start
            // and what only its end supplies must not be wanted in between.
            let early = |fact: &FactId| {
                operator.start_condition.positive.contains(fact)
                    || operator.invariant.positive.contains(fact)
                    || adds(&operator.start_effects, *fact)
            };
            operator.end_condition.positive.iter().all(early)
                && operator.end_condition.negative.is_empty()
                && operator.end_condition.comparisons.is_empty()
                && operator.start_effects.iter().all(|effect| match effect.change {
                    Change::Add(fact) => !deletes(&operator.end_effects, fact),
                    Change::Delete(fact) => {
                        !self.negative.contains(&fact) || !adds(&operator.end_effects, fact)
                    }
                    Change::Assign(..) => operator.end_effects.iter().all(|other| {
                        !matches!((&effect.change, &other.change),
                            (Change::Assign(_, left, _), Change::Assign(_, right, _)) if left == right)
                    }),
                    Change::Call(_) => false,
                })
        })
    }
}
