//! Leaves out operators, facts and fluents on which the goal does not depend.
//!
//! Backward relevance: a fact or fluent matters if the goal, the metric or a condition of something
//! that matters reads it; an operator matters if it changes something that matters in the useful
//! direction. Removing any other operator from a plan leaves a plan, so the pruning is sound and
//! keeps optimal plans. A fact that is not read stays if it is both added and deleted, because
//! two such changes at one instant interfere (PDDL 2.1, definition 12).

use crate::task::{
    Change, Conjunction, Duration, FactId, FluentId, GroundEffect, GroundExpression, Operator, Task,
};

#[derive(Default)]
struct Relevance {
    wanted_true: Vec<bool>,
    wanted_false: Vec<bool>,
    fluents: Vec<bool>,
}

/// Prunes the task in place. Not for tasks with attachments that read the whole state.
pub(super) fn prune(task: &mut Task) {
    let mut relevance = Relevance {
        wanted_true: vec![false; task.facts.len()],
        wanted_false: vec![false; task.facts.len()],
        fluents: vec![false; task.fluents.len()],
    };
    relevance.conjunction(&task.goal);
    if let Some(metric) = &task.metric {
        relevance.expression(&metric.expression);
    }
    let mut kept = vec![false; task.operators.len()];
    let mut kept_axioms = vec![false; task.axioms.len()];
    loop {
        let mut changed = false;
        for (axiom, kept) in task.axioms.iter().zip(&mut kept_axioms) {
            let head = axiom.head.index();
            if !*kept && (relevance.wanted_true[head] || relevance.wanted_false[head]) {
                *kept = true;
                changed = true;
                relevance.conjunction(&axiom.condition);
                if relevance.wanted_false[head] {
                    relevance.negated(&axiom.condition);
                }
            }
        }
        for (operator, kept) in task.operators.iter().zip(&mut kept) {
            if !*kept && relevance.useful(operator) {
                *kept = true;
                changed = true;
                relevance.operator(operator);
            }
        }
        if !changed {
            break;
        }
    }
    retain(&mut task.operators, &kept);
    retain(&mut task.axioms, &kept_axioms);
    renumber(task, &relevance);
}

fn retain<T>(list: &mut Vec<T>, kept: &[bool]) {
    let mut flags = kept.iter();
    list.retain(|_| *flags.next().unwrap_or(&true));
}

impl Relevance {
    fn conjunction(&mut self, conjunction: &Conjunction) {
        for fact in &conjunction.positive {
            self.wanted_true[fact.index()] = true;
        }
        for fact in &conjunction.negative {
            self.wanted_false[fact.index()] = true;
        }
        for comparison in &conjunction.comparisons {
            self.expression(&comparison.left);
            self.expression(&comparison.right);
        }
    }

    fn negated(&mut self, conjunction: &Conjunction) {
        for fact in &conjunction.positive {
            self.wanted_false[fact.index()] = true;
        }
        for fact in &conjunction.negative {
            self.wanted_true[fact.index()] = true;
        }
    }

    fn expression(&mut self, expression: &GroundExpression) {
        match expression {
            GroundExpression::Fluent(fluent) => self.fluents[fluent.index()] = true,
            GroundExpression::Binary(_, left, right) => {
                self.expression(left);
                self.expression(right);
            }
            GroundExpression::Constant(_)
            | GroundExpression::Duration
            | GroundExpression::TotalTime
            | GroundExpression::Call(_) => {}
        }
    }

    fn useful_change(&self, change: &Change) -> bool {
        match change {
            Change::Add(fact) => self.wanted_true[fact.index()],
            Change::Delete(fact) => self.wanted_false[fact.index()],
            Change::Assign(_, fluent, _) => self.fluents[fluent.index()],
            Change::Call(_) => true,
        }
    }

    fn useful(&self, operator: &Operator) -> bool {
        effects(operator).any(|effect| self.useful_change(&effect.change))
    }

    fn operator(&mut self, operator: &Operator) {
        self.conjunction(&operator.start_condition);
        self.conjunction(&operator.invariant);
        self.conjunction(&operator.end_condition);
        if let Some(Duration::Bounds(lower, upper)) = &operator.duration {
            self.expression(lower);
            self.expression(upper);
        }
        for effect in effects(operator) {
            if let Some(conditions) = &effect.condition {
                for condition in conditions.iter() {
                    self.conjunction(condition);
                    self.negated(condition);
                }
            }
            if let Change::Assign(_, _, value) = &effect.change {
                self.expression(value);
            }
        }
    }
}

fn effects(operator: &Operator) -> impl Iterator<Item = &GroundEffect> {
    operator.start_effects.iter().chain(&operator.end_effects)
}

/// Drops facts and fluents that nothing reads and renumbers the rest.
fn renumber(task: &mut Task, relevance: &Relevance) {
    let mut added = vec![false; task.facts.len()];
    let mut deleted = vec![false; task.facts.len()];
    let mut plain = vec![true; task.fluents.len()];
    let timed = task.timed.iter().map(|event| &event.change);
    for change in task
        .operators
        .iter()
        .flat_map(effects)
        .map(|effect| &effect.change)
        .chain(timed)
    {
        match change {
            Change::Add(fact) => added[fact.index()] = true,
            Change::Delete(fact) => deleted[fact.index()] = true,
            Change::Assign(assignment, fluent, _) => {
                plain[fluent.index()] &= matches!(
                    assignment,
                    crate::pddl::model::Assignment::Increase
                        | crate::pddl::model::Assignment::Decrease
                );
            }
            Change::Call(_) => {}
        }
    }
    let written: Vec<FluentId> = task.calls.iter().flat_map(|c| c.writes.clone()).collect();
    for fluent in written {
        plain[fluent.index()] = false;
    }
    let mut also_read = vec![false; task.facts.len()];
    for fact in task
        .operators
        .iter()
        .flat_map(|o| o.also_reads.iter().flatten())
    {
        also_read[fact.index()] = true;
    }
    let mut next = 0;
    let facts: Vec<Option<FactId>> = (0..task.facts.len())
        .map(|fact| {
            let read =
                relevance.wanted_true[fact] || relevance.wanted_false[fact] || also_read[fact];
            (read || (added[fact] && deleted[fact])).then(|| {
                next += 1;
                FactId(next - 1)
            })
        })
        .collect();
    next = 0;
    let fluents: Vec<Option<FluentId>> = (0..task.fluents.len())
        .map(|fluent| {
            (relevance.fluents[fluent] || !plain[fluent]).then(|| {
                next += 1;
                FluentId(next - 1)
            })
        })
        .collect();
    let maps = Maps { facts, fluents };
    maps.apply(task);
}

struct Maps {
    facts: Vec<Option<FactId>>,
    fluents: Vec<Option<FluentId>>,
}

impl Maps {
    fn apply(&self, task: &mut Task) {
        let mut index = 0;
        task.facts.retain(|_| {
            index += 1;
            self.facts[index - 1].is_some()
        });
        index = 0;
        task.atoms.retain(|_| {
            index += 1;
            self.facts[index - 1].is_some()
        });
        index = 0;
        task.fluents.retain(|_| {
            index += 1;
            self.fluents[index - 1].is_some()
        });
        index = 0;
        task.initial_values.retain(|_| {
            index += 1;
            self.fluents[index - 1].is_some()
        });
        task.initial_facts = task
            .initial_facts
            .iter()
            .filter_map(|fact| self.facts[fact.index()])
            .collect();
        self.conjunction(&mut task.goal);
        if let Some(metric) = &mut task.metric {
            self.expression(&mut metric.expression);
        }
        for axiom in &mut task.axioms {
            self.conjunction(&mut axiom.condition);
            if let Some(head) = self.facts[axiom.head.index()] {
                axiom.head = head;
            }
        }
        for call in &mut task.calls {
            for fluent in &mut call.writes {
                if let Some(id) = self.fluents[fluent.index()] {
                    *fluent = id;
                }
            }
        }
        task.timed
            .retain_mut(|event| self.change(&mut event.change));
        for operator in &mut task.operators {
            self.conjunction(&mut operator.start_condition);
            self.conjunction(&mut operator.invariant);
            self.conjunction(&mut operator.end_condition);
            for list in &mut operator.also_reads {
                self.list(list);
            }
            if let Some(Duration::Bounds(lower, upper)) = &mut operator.duration {
                self.expression(lower);
                self.expression(upper);
            }
            for effects in [&mut operator.start_effects, &mut operator.end_effects] {
                effects.retain_mut(|effect| {
                    if let Some(conditions) = &mut effect.condition {
                        for condition in conditions.iter_mut() {
                            self.conjunction(condition);
                        }
                    }
                    self.change(&mut effect.change)
                });
            }
        }
    }

    fn list(&self, facts: &mut Vec<FactId>) {
        facts.retain_mut(|fact| {
            let kept = self.facts[fact.index()];
            *fact = kept.unwrap_or(*fact);
            kept.is_some()
        });
    }

    fn conjunction(&self, conjunction: &mut Conjunction) {
        self.list(&mut conjunction.positive);
        self.list(&mut conjunction.negative);
        for comparison in &mut conjunction.comparisons {
            self.expression(&mut comparison.left);
            self.expression(&mut comparison.right);
        }
    }

    fn expression(&self, expression: &mut GroundExpression) {
        match expression {
            GroundExpression::Fluent(fluent) => {
                if let Some(id) = self.fluents[fluent.index()] {
                    *fluent = id;
                }
            }
            GroundExpression::Binary(_, left, right) => {
                self.expression(left);
                self.expression(right);
            }
            GroundExpression::Constant(_)
            | GroundExpression::Duration
            | GroundExpression::TotalTime
            | GroundExpression::Call(_) => {}
        }
    }

    /// Renumbers a change; false if what it changes is gone.
    fn change(&self, change: &mut Change) -> bool {
        match change {
            Change::Add(fact) | Change::Delete(fact) => match self.facts[fact.index()] {
                Some(id) => {
                    *fact = id;
                    true
                }
                None => false,
            },
            Change::Assign(_, fluent, value) => match self.fluents[fluent.index()] {
                Some(id) => {
                    *fluent = id;
                    self.expression(value);
                    true
                }
                None => false,
            },
            Change::Call(_) => true,
        }
    }
}
