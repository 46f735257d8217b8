//! The delete relaxation of a temporal task: propositions and actions without deletes.
//!
//! A durative operator becomes up to two relaxed actions. The *start* gives its start effects as
//! soon as its start and over-all conditions hold; the *whole* gives its end effects after its
//! duration and needs its end conditions too. A conditional effect becomes an action of its own.
//! Propositions are facts, negated facts that something reads, and numeric comparisons. A fact
//! that ends of operators delete and others need throughout has a second proposition, *lasting*,
//! which the latter need: it lets a heuristic see that a window that is about to close is of no
//! use to an action that takes longer.

use rustc_hash::FxHashMap;

use crate::pddl::model::{Arithmetic, Assignment};
use crate::task::{
    Change, Conjunction, Duration, FactId, FluentId, GroundEffect, GroundExpression,
    NumericCondition, Operator, OperatorId, Task,
};

/// Index of a proposition.
pub type Proposition = u32;

/// A way to make a comparison true: by the change of one fluent.
#[derive(Clone, Debug)]
pub struct NumericSupport {
    /// Index into [`RelaxedTask::comparisons`].
    pub comparison: u32,
    /// How the fluent changes.
    pub assignment: Option<Assignment>,
    /// By how much; `None` for an effect module.
    pub value: Option<GroundExpression>,
    /// Coefficient of the fluent in `left - right`; NaN if that is not linear.
    pub coefficient: f64,
}

/// A relaxed action.
#[derive(Clone, Debug)]
pub struct RelaxedAction {
    /// The operator it stands for.
    pub operator: OperatorId,
    /// From its start to its effects: 0 or the least duration [s].
    pub delay: f64,
    /// Number of preconditions.
    pub preconditions: u32,
    /// What it makes true.
    pub adds: Vec<Proposition>,
    /// Comparisons it may make true.
    pub numeric: Vec<NumericSupport>,
}

/// A numeric comparison as a proposition.
#[derive(Clone, Debug)]
pub struct RelaxedComparison {
    /// The comparison.
    pub condition: NumericCondition,
    /// `left - right` as a linear form, if it is one.
    pub linear: Option<Vec<(FluentId, f64)>>,
}

/// The relaxed task.
#[derive(Clone, Debug)]
pub struct RelaxedTask {
    /// Number of facts; propositions `0..facts` are the facts themselves.
    pub facts: u32,
    /// Facts with a proposition for their negation, and that proposition.
    pub negations: Vec<(FactId, Proposition)>,
    /// Facts with a proposition for lasting, and that proposition.
    pub lasting: Vec<(FactId, Proposition)>,
    /// Comparisons; their propositions start at `first_comparison`.
    pub comparisons: Vec<RelaxedComparison>,
    /// First comparison's proposition.
    pub first_comparison: Proposition,
    /// Number of propositions.
    pub propositions: u32,
    /// All actions.
    pub actions: Vec<RelaxedAction>,
    /// Preconditions of all actions, one after the other.
    pub preconditions: Vec<Proposition>,
    /// Where each action's preconditions begin, with a last entry for the end.
    pub precondition_offsets: Vec<u32>,
    /// Actions by precondition, one list after the other.
    pub readers: Vec<u32>,
    /// Parallel to `readers`: whether the precondition is due only when the effects happen.
    pub late: Vec<bool>,
    /// Where each proposition's list begins, with a last entry for the end.
    pub reader_offsets: Vec<u32>,
    /// Actions without preconditions.
    pub unconditional: Vec<u32>,
    /// Goal propositions.
    pub goal: Vec<Proposition>,
    /// End effects of each operator as propositions, for operators that run.
    pub end_adds: Vec<Vec<Proposition>>,
}

impl RelaxedTask {
    /// Relaxes a task.
    #[must_use]
    pub fn new(task: &Task) -> Self {
        Builder::new(task).build()
    }

    /// The preconditions of an action.
    #[inline]
    #[must_use]
    pub fn preconditions_of(&self, action: u32) -> &[Proposition] {
        let range = self.precondition_offsets[action as usize] as usize
            ..self.precondition_offsets[action as usize + 1] as usize;
        &self.preconditions[range]
    }

    /// The propositions for a fact's lasting.
    pub fn lasting_of(&self, fact: FactId) -> impl Iterator<Item = Proposition> + '_ {
        let from = self.lasting.partition_point(|entry| entry.0 < fact);
        self.lasting[from..]
            .iter()
            .take_while(move |entry| entry.0 == fact)
            .map(|entry| entry.1)
    }

    /// The actions that a proposition is a precondition of, and whether it is due only at their
    /// effects.
    pub fn timed_readers_of(
        &self,
        proposition: Proposition,
    ) -> impl Iterator<Item = (u32, bool)> + '_ {
        let range = self.reader_offsets[proposition as usize] as usize
            ..self.reader_offsets[proposition as usize + 1] as usize;
        self.readers[range.clone()]
            .iter()
            .copied()
            .zip(self.late[range].iter().copied())
    }

    /// The actions that a proposition is a precondition of.
    #[inline]
    #[must_use]
    pub fn readers_of(&self, proposition: Proposition) -> &[u32] {
        let range = self.reader_offsets[proposition as usize] as usize
            ..self.reader_offsets[proposition as usize + 1] as usize;
        &self.readers[range]
    }
}

struct Builder<'a> {
    task: &'a Task,
    negation_of: FxHashMap<FactId, Proposition>,
    negations: Vec<(FactId, Proposition)>,
    /// By window length, shortest first.
    lasting_of: FxHashMap<FactId, Vec<(f64, Proposition)>>,
    lasting: Vec<(FactId, Proposition)>,
    comparisons: Vec<RelaxedComparison>,
    first_comparison: Proposition,
    actions: Vec<RelaxedAction>,
    preconditions: Vec<Vec<Proposition>>,
    late: Vec<Vec<Proposition>>,
}

impl<'a> Builder<'a> {
    fn new(task: &'a Task) -> Self {
        let mut builder = Self {
            task,
            negation_of: FxHashMap::default(),
            negations: Vec::new(),
            lasting_of: FxHashMap::default(),
            lasting: Vec::new(),
            comparisons: Vec::new(),
            first_comparison: 0,
            actions: Vec::new(),
            preconditions: Vec::new(),
            late: Vec::new(),
        };
        let mut conjunctions: Vec<&Conjunction> = vec![&task.goal];
        for operator in &task.operators {
            conjunctions.extend([
                &operator.start_condition,
                &operator.invariant,
                &operator.end_condition,
            ]);
            for effect in operator.start_effects.iter().chain(&operator.end_effects) {
                conjunctions.extend(effect.condition.iter().flat_map(|c| c.iter()));
            }
        }
        conjunctions.extend(task.axioms.iter().map(|axiom| &axiom.condition));
        let mut negated: Vec<FactId> = conjunctions
            .iter()
            .flat_map(|conjunction| conjunction.negative.iter().copied())
            .collect();
        negated.sort_unstable();
        negated.dedup();
        for fact in negated {
            let proposition = (task.facts.len() + builder.negations.len()) as Proposition;
            builder.negations.push((fact, proposition));
            builder.negation_of.insert(fact, proposition);
        }
        for (fact, windows) in windows(task) {
            for window in windows {
                let before = task.facts.len() + builder.negations.len() + builder.lasting.len();
                let proposition = before as Proposition;
                builder.lasting.push((fact, proposition));
                builder
                    .lasting_of
                    .entry(fact)
                    .or_default()
                    .push((window, proposition));
            }
        }
        builder.first_comparison =
            (task.facts.len() + builder.negations.len() + builder.lasting.len()) as Proposition;
        for conjunction in conjunctions {
            for condition in &conjunction.comparisons {
                builder.comparison(condition);
            }
        }
        builder
    }

    fn comparison(&mut self, condition: &NumericCondition) -> Proposition {
        let known = self
            .comparisons
            .iter()
            .position(|other| other.condition == *condition);
        let index = known.unwrap_or_else(|| {
            let mut form = Vec::new();
            let linear = linear(&condition.left, 1.0, &mut form)
                && linear(&condition.right, -1.0, &mut form);
            self.comparisons.push(RelaxedComparison {
                condition: condition.clone(),
                linear: linear.then_some(form),
            });
            self.comparisons.len() - 1
        });
        self.first_comparison + index as Proposition
    }

    fn propositions(&mut self, conjunction: &Conjunction, into: &mut Vec<Proposition>) {
        into.extend(conjunction.positive.iter().map(|fact| fact.0));
        into.extend(
            conjunction
                .negative
                .iter()
                .map(|fact| self.negation_of[fact]),
        );
        for condition in &conjunction.comparisons {
            let proposition = self.comparison(condition);
            into.push(proposition);
        }
    }

    /// What a change makes true; a fact that it adds lasts for `window`.
    fn effect(
        &self,
        change: &Change,
        window: f64,
        adds: &mut Vec<Proposition>,
        numeric: &mut Vec<NumericSupport>,
    ) {
        match change {
            Change::Add(fact) => {
                adds.push(fact.0);
                if let Some(classes) = self.lasting_of.get(fact) {
                    let fits = classes.iter().filter(|class| class.0 <= window);
                    adds.extend(fits.map(|class| class.1));
                }
            }
            Change::Delete(fact) => adds.extend(self.negation_of.get(fact)),
            Change::Assign(assignment, fluent, value) => {
                self.supports(*fluent, Some((*assignment, value)), numeric);
            }
            Change::Call(call) => {
                for fluent in &self.task.calls[call.index()].writes {
                    self.supports(*fluent, None, numeric);
                }
            }
        }
    }

    fn supports(
        &self,
        fluent: FluentId,
        change: Option<(Assignment, &GroundExpression)>,
        numeric: &mut Vec<NumericSupport>,
    ) {
        for (index, comparison) in self.comparisons.iter().enumerate() {
            let coefficient = match &comparison.linear {
                Some(form) => form
                    .iter()
                    .filter(|(f, _)| *f == fluent)
                    .map(|(_, c)| c)
                    .sum(),
                None if mentions(&comparison.condition, fluent) => f64::NAN,
                None => 0.0,
            };
            if coefficient != 0.0 {
                numeric.push(NumericSupport {
                    comparison: index as u32,
                    assignment: change.map(|(assignment, _)| assignment),
                    value: change.map(|(_, value)| value.clone()),
                    coefficient,
                });
            }
        }
    }

    fn build(mut self) -> RelaxedTask {
        let task = self.task;
        let mut end_adds = Vec::with_capacity(task.operators.len());
        for (index, operator) in task.operators.iter().enumerate() {
            let id = OperatorId(index as u32);
            let own: Vec<Proposition> = {
                let (mut adds, mut numeric) = (Vec::new(), Vec::new());
                for effect in &operator.start_effects {
                    if effect.condition.is_none() {
                        self.effect(&effect.change, f64::INFINITY, &mut adds, &mut numeric);
                    }
                }
                let first = self.first_comparison;
                adds.extend(numeric.iter().map(|support| first + support.comparison));
                adds
            };
            let delay = least_duration(operator);
            let mut early = Vec::new();
            self.propositions(&operator.start_condition, &mut early);
            let mut during = Vec::new();
            self.propositions(&operator.invariant, &mut during);
            for proposition in during.into_iter().filter(|p| !own.contains(p)) {
                let classes = self.lasting_of.get(&FactId(proposition));
                let class = classes.and_then(|c| c.iter().find(|class| class.0 >= delay));
                early.push(class.map_or(proposition, |class| class.1));
            }
            let mut late = Vec::new();
            self.propositions(&operator.end_condition, &mut late);
            late.retain(|p| !own.contains(p) && !early.contains(p));
            self.effects(id, 0.0, &early, &[], &operator.start_effects);
            self.effects(id, delay, &early, &late, &operator.end_effects);
            let (mut adds, mut numeric) = (Vec::new(), Vec::new());
            for effect in &operator.end_effects {
                if effect.condition.is_none() {
                    self.effect(&effect.change, f64::INFINITY, &mut adds, &mut numeric);
                }
            }
            end_adds.push(adds);
        }
        for axiom in &task.axioms {
            let mut condition = Vec::new();
            self.propositions(&axiom.condition, &mut condition);
            self.push(
                OperatorId(u32::MAX),
                0.0,
                condition,
                Vec::new(),
                vec![axiom.head.0],
                Vec::new(),
            );
            if let Some(&negation) = self.negation_of.get(&axiom.head) {
                // Optimistic: a derived fact can always be made false.
                self.push(
                    OperatorId(u32::MAX),
                    0.0,
                    Vec::new(),
                    Vec::new(),
                    vec![negation],
                    Vec::new(),
                );
            }
        }
        let mut goal = Vec::new();
        self.propositions(&task.goal, &mut goal);
        goal.sort_unstable();
        goal.dedup();
        self.finish(goal, end_adds)
    }

    /// For how long an operator's own start effect holds: until its end, if that deletes it.
    fn window(&self, id: OperatorId, delay: f64, change: &Change) -> f64 {
        let operator = &self.task.operators[id.index()];
        match (change, &operator.duration) {
            (Change::Add(fact), Some(Duration::Fixed(seconds)))
                if delay == 0.0 && deletes_at_end(operator, *fact) =>
            {
                *seconds
            }
            _ => f64::INFINITY,
        }
    }

    fn effects(
        &mut self,
        id: OperatorId,
        delay: f64,
        early: &[Proposition],
        late: &[Proposition],
        effects: &[GroundEffect],
    ) {
        let (mut adds, mut numeric) = (Vec::new(), Vec::new());
        for effect in effects {
            match &effect.condition {
                None => {
                    let window = self.window(id, delay, &effect.change);
                    self.effect(&effect.change, window, &mut adds, &mut numeric);
                }
                Some(parts) => {
                    let (mut early, mut late) = (early.to_vec(), late.to_vec());
                    self.propositions(&parts[0], &mut early);
                    self.propositions(&parts[1], &mut late);
                    self.propositions(&parts[2], &mut late);
                    let (mut adds, mut numeric) = (Vec::new(), Vec::new());
                    self.effect(&effect.change, f64::INFINITY, &mut adds, &mut numeric);
                    self.push(id, delay, early, late, adds, numeric);
                }
            }
        }
        self.push(id, delay, early.to_vec(), late.to_vec(), adds, numeric);
    }

    fn push(
        &mut self,
        operator: OperatorId,
        delay: f64,
        early: Vec<Proposition>,
        mut late: Vec<Proposition>,
        mut adds: Vec<Proposition>,
        numeric: Vec<NumericSupport>,
    ) {
        late.retain(|proposition| !early.contains(proposition));
        let mut conditions = early;
        conditions.extend_from_slice(&late);
        conditions.sort_unstable();
        conditions.dedup();
        adds.retain(|add| conditions.binary_search(add).is_err());
        if adds.is_empty() && numeric.is_empty() {
            return;
        }
        self.actions.push(RelaxedAction {
            operator,
            delay,
            preconditions: conditions.len() as u32,
            adds,
            numeric,
        });
        self.preconditions.push(conditions);
        self.late.push(late);
    }

    fn finish(self, goal: Vec<Proposition>, end_adds: Vec<Vec<Proposition>>) -> RelaxedTask {
        let propositions = self.first_comparison as usize + self.comparisons.len();
        let mut lists: Vec<Vec<(u32, bool)>> = vec![Vec::new(); propositions];
        let mut unconditional = Vec::new();
        let mut flat = Vec::new();
        let mut offsets = vec![0];
        for (index, conditions) in self.preconditions.iter().enumerate() {
            if conditions.is_empty() {
                unconditional.push(index as u32);
            }
            for &proposition in conditions {
                let late = self.late[index].contains(&proposition);
                lists[proposition as usize].push((index as u32, late));
                flat.push(proposition);
            }
            offsets.push(flat.len() as u32);
        }
        let mut readers = Vec::with_capacity(flat.len());
        let mut late = Vec::with_capacity(flat.len());
        let mut reader_offsets = vec![0];
        for list in lists {
            readers.extend(list.iter().map(|(action, _)| action));
            late.extend(list.iter().map(|(_, late)| late));
            reader_offsets.push(readers.len() as u32);
        }
        RelaxedTask {
            facts: self.task.facts.len() as u32,
            negations: self.negations,
            lasting: self.lasting,
            comparisons: self.comparisons,
            first_comparison: self.first_comparison,
            propositions: propositions as u32,
            actions: self.actions,
            preconditions: flat,
            precondition_offsets: offsets,
            readers,
            late,
            reader_offsets,
            unconditional,
            goal,
            end_adds,
        }
    }
}

/// Facts that an operator's end deletes and another operator needs throughout, sorted, with the
/// lengths of the windows in which they hold, sorted; the last one is infinite.
fn windows(task: &Task) -> Vec<(FactId, Vec<f64>)> {
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

fn deletes_at_end(operator: &Operator, fact: FactId) -> bool {
    operator
        .end_effects
        .iter()
        .any(|effect| effect.condition.is_none() && effect.change == Change::Delete(fact))
}

fn least_duration(operator: &Operator) -> f64 {
    match &operator.duration {
        Some(Duration::Fixed(value) | Duration::Bounds(GroundExpression::Constant(value), _)) => {
            *value
        }
        _ => 0.0,
    }
}

/// Adds `factor * expression` to a linear form; false if it is not linear.
fn linear(expression: &GroundExpression, factor: f64, form: &mut Vec<(FluentId, f64)>) -> bool {
    match expression {
        GroundExpression::Constant(_) => true,
        GroundExpression::Fluent(fluent) => {
            form.push((*fluent, factor));
            true
        }
        GroundExpression::Binary(Arithmetic::Add, left, right) => {
            linear(left, factor, form) && linear(right, factor, form)
        }
        GroundExpression::Binary(Arithmetic::Subtract, left, right) => {
            linear(left, factor, form) && linear(right, -factor, form)
        }
        GroundExpression::Binary(Arithmetic::Multiply, left, right) => {
            match (left.as_ref(), right.as_ref()) {
                (GroundExpression::Constant(k), other) | (other, GroundExpression::Constant(k)) => {
                    linear(other, factor * k, form)
                }
                _ => false,
            }
        }
        GroundExpression::Binary(Arithmetic::Divide, left, right) => match right.as_ref() {
            GroundExpression::Constant(k) => linear(left, factor / k, form),
            _ => false,
        },
        GroundExpression::Binary(Arithmetic::Minimum | Arithmetic::Maximum, ..)
        | GroundExpression::Duration
        | GroundExpression::TotalTime
        | GroundExpression::Call(_) => false,
    }
}

fn mentions(condition: &NumericCondition, fluent: FluentId) -> bool {
    fn inside(expression: &GroundExpression, fluent: FluentId) -> bool {
        match expression {
            GroundExpression::Fluent(other) => *other == fluent,
            GroundExpression::Binary(_, left, right) => {
                inside(left, fluent) || inside(right, fluent)
            }
            GroundExpression::Call(_) => true,
            _ => false,
        }
    }
    inside(&condition.left, fluent) || inside(&condition.right, fluent)
}
