//! Builds the delete relaxation.

use rustc_hash::FxHashMap;

use crate::task::{
    Change, Conjunction, Duration, FactId, GroundEffect, GroundExpression, NumericCondition,
    Operator, OperatorId, Task,
};

use super::linear::linear;
use super::windows::{deletes_at_end, windows};
use super::{
    MANY, NumericSupport, Proposition, Reader, RelaxedAction, RelaxedComparison, RelaxedTask,
};

pub(super) struct Builder<'a> {
    task: &'a Task,
    negation_of: FxHashMap<FactId, Proposition>,
    negations: Vec<(FactId, Proposition)>,
    /// By window length, shortest first.
    lasting_of: FxHashMap<FactId, Vec<(f64, Proposition)>>,
    lasting: Vec<(FactId, Proposition)>,
    pub(super) comparisons: Vec<RelaxedComparison>,
    /// Comparisons by how they are written.
    comparison_of: FxHashMap<String, usize>,
    first_comparison: Proposition,
    pub(super) supports: Vec<NumericSupport>,
    pub(super) changes: Vec<(u32, u32)>,
    /// Changes by how they are written.
    pub(super) change_of: FxHashMap<String, u32>,
    actions: Vec<RelaxedAction>,
    preconditions: Vec<Vec<Proposition>>,
    late: Vec<Vec<Proposition>>,
    adds: Vec<Vec<Proposition>>,
}

impl<'a> Builder<'a> {
    pub(super) fn new(task: &'a Task) -> Self {
        let mut builder = Self {
            task,
            negation_of: FxHashMap::default(),
            negations: Vec::new(),
            lasting_of: FxHashMap::default(),
            lasting: Vec::new(),
            comparisons: Vec::new(),
            comparison_of: FxHashMap::default(),
            first_comparison: 0,
            supports: Vec::new(),
            changes: Vec::new(),
            change_of: FxHashMap::default(),
            actions: Vec::new(),
            preconditions: Vec::new(),
            late: Vec::new(),
            adds: Vec::new(),
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
        let comparisons = &mut self.comparisons;
        let written = self.comparison_of.entry(format!("{condition:?}"));
        let index = *written.or_insert_with(|| {
            let mut form = Vec::new();
            let linear = linear(&condition.left, 1.0, &mut form)
                && linear(&condition.right, -1.0, &mut form);
            comparisons.push(RelaxedComparison {
                condition: condition.clone(),
                linear: linear.then_some(form),
            });
            comparisons.len() - 1
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
        &mut self,
        change: &Change,
        window: f64,
        adds: &mut Vec<Proposition>,
        numeric: &mut Vec<u32>,
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
                numeric.extend(self.supports(*fluent, Some((*assignment, value))));
            }
            Change::Call(call) => {
                for fluent in &self.task.calls[call.index()].writes {
                    numeric.extend(self.supports(*fluent, None));
                }
            }
        }
    }

    pub(super) fn build(mut self) -> RelaxedTask {
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
                for change in numeric {
                    let (from, to) = self.changes[change as usize];
                    let supports = &self.supports[from as usize..to as usize];
                    let first = self.first_comparison;
                    adds.extend(supports.iter().map(|support| first + support.comparison));
                }
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
        changes: Vec<u32>,
    ) {
        late.retain(|proposition| !early.contains(proposition));
        let mut conditions = early;
        conditions.extend_from_slice(&late);
        conditions.sort_unstable();
        conditions.dedup();
        adds.retain(|add| conditions.binary_search(add).is_err());
        if adds.is_empty() && changes.is_empty() {
            return;
        }
        self.actions.push(RelaxedAction {
            operator,
            delay,
            preconditions: conditions.len() as u32,
            changes,
        });
        self.adds.push(adds);
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
        let mut adds = Vec::new();
        let mut add_offsets = vec![0];
        for list in &self.adds {
            adds.extend_from_slice(list);
            add_offsets.push(adds.len() as u32);
        }
        let reader = |action: u32| {
            let relaxed = &self.actions[action as usize];
            let only_add = match self.adds[action as usize].as_slice() {
                [add] if relaxed.changes.is_empty() && !relaxed.is_axiom() => *add,
                _ => MANY,
            };
            Reader { action, only_add }
        };
        let mut readers = Vec::with_capacity(flat.len());
        let mut late = Vec::with_capacity(flat.len());
        let mut reader_offsets = vec![0];
        for list in lists {
            readers.extend(list.iter().map(|(action, _)| reader(*action)));
            late.extend(list.iter().map(|(_, late)| late));
            reader_offsets.push(readers.len() as u32);
        }
        RelaxedTask {
            facts: self.task.facts.len() as u32,
            negations: self.negations,
            lasting: self.lasting,
            comparisons: self.comparisons,
            first_comparison: self.first_comparison,
            supports: self.supports,
            changes: self.changes,
            propositions: propositions as u32,
            actions: self.actions,
            preconditions: flat,
            precondition_offsets: offsets,
            adds,
            add_offsets,
            readers,
            late,
            reader_offsets,
            unconditional,
            goal,
            end_adds,
        }
    }
}

fn least_duration(operator: &Operator) -> f64 {
    match &operator.duration {
        Some(Duration::Fixed(value) | Duration::Bounds(GroundExpression::Constant(value), _)) => {
            *value
        }
        _ => 0.0,
    }
}
