//! Operators prepared for search: bit tests for conditions, reads and writes of each happening.

use crate::task::{
    Change, Conjunction, Duration, FactId, GroundEffect, GroundExpression, Operator, OperatorId,
    Task,
};

pub use super::condition::{Condition, comparison_holds, evaluate};
use super::happening::meet;
pub use super::happening::{Effect, Happening, too_close};

/// An operator prepared for search.
#[derive(Clone, Debug)]
pub struct CompiledOperator {
    /// Must hold when it starts.
    pub start_condition: Condition,
    /// Must hold while it runs.
    pub invariant: Condition,
    /// Must hold when it ends.
    pub end_condition: Condition,
    /// Its start.
    pub start: Happening,
    /// Its end.
    pub end: Happening,
    /// How long it takes; `None` for an instantaneous action.
    pub duration: Option<Duration>,
    /// Its duration, or the shortest one if that is known before searching, or 0.
    pub least_duration: f64,
    /// Whether a second copy may usefully run beside the first: it changes numbers.
    pub may_overlap_itself: bool,
    /// Whether any effect depends on a condition at its start or throughout.
    pub remembers: bool,
    /// Facts that must stay true, and false, while it runs.
    kept: [Vec<FactId>; 2],
    /// Facts that its end certainly makes false, and true.
    spoils: [Vec<FactId>; 2],
}

/// The task in the form that the search works on.
#[derive(Clone, Debug)]
pub struct Compiled<'a> {
    /// The task it was made from.
    pub task: &'a Task,
    /// Words of a fact set.
    pub words: usize,
    /// By [`OperatorId`].
    pub operators: Vec<CompiledOperator>,
    /// Timed initial literals as happenings, by position in `task.timed`.
    pub timed: Vec<Happening>,
    /// The goal.
    pub goal: Condition,
    /// Axioms in the order of their strata.
    pub axioms: Vec<(u32, Condition, FactId)>,
    /// Facts set by axioms.
    pub derived: Vec<FactId>,
}

impl<'a> Compiled<'a> {
    /// Prepares a task.
    #[must_use]
    pub fn new(task: &'a Task) -> Self {
        let operators = task.operators.iter();
        Self::with(task, operators.map(|each| compile(task, each)).collect())
    }

    /// Prepares a task unless `stop` says so meanwhile.
    #[must_use]
    pub fn unless(stop: &dyn Fn() -> bool, task: &'a Task) -> Option<Self> {
        let mut operators = Vec::with_capacity(task.operators.len());
        for batch in task.operators.chunks(4_096) {
            if stop() {
                return None;
            }
            operators.extend(batch.iter().map(|each| compile(task, each)));
        }
        Some(Self::with(task, operators))
    }

    /// Prepares these operators only, numbered in the order given.
    #[must_use]
    pub fn only(task: &'a Task, operators: &[OperatorId]) -> Self {
        let operators = operators.iter().map(|id| &task.operators[id.index()]);
        Self::with(task, operators.map(|each| compile(task, each)).collect())
    }

    fn with(task: &'a Task, operators: Vec<CompiledOperator>) -> Self {
        let mut derived: Vec<FactId> = task.axioms.iter().map(|axiom| axiom.head).collect();
        derived.sort_unstable();
        derived.dedup();
        Self {
            task,
            words: task.facts.len().div_ceil(64),
            operators,
            timed: task
                .timed
                .iter()
                .map(|event| {
                    let effect = GroundEffect {
                        condition: None,
                        change: event.change.clone(),
                    };
                    Happening::of(task, &Conjunction::default(), &[effect])
                })
                .collect(),
            goal: Condition::new(&task.goal),
            axioms: task
                .axioms
                .iter()
                .map(|axiom| (axiom.stratum, Condition::new(&axiom.condition), axiom.head))
                .collect(),
            derived,
        }
    }

    /// The operator behind an id.
    #[must_use]
    pub fn operator(&self, operator: OperatorId) -> &CompiledOperator {
        &self.operators[operator.index()]
    }
}

fn compile(task: &Task, operator: &Operator) -> CompiledOperator {
    let all = || operator.start_effects.iter().chain(&operator.end_effects);
    let mut start = Happening::of(task, &operator.start_condition, &operator.start_effects);
    if let Some(Duration::Bounds(lower, upper)) = &operator.duration {
        start.read_expression(lower);
        start.read_expression(upper);
    }
    for effect in &operator.end_effects {
        if let Some(conditions) = &effect.condition {
            start.read(&conditions[0]);
        }
    }
    start.reads.extend(&operator.also_reads[0]);
    start.reads.sort_unstable();
    start.reads.dedup();
    let mut end = Happening::of(task, &operator.end_condition, &operator.end_effects);
    end.reads.extend(&operator.also_reads[1]);
    end.reads.sort_unstable();
    end.reads.dedup();
    if operator.duration.is_none() {
        end = Happening::default();
    }
    CompiledOperator {
        start_condition: Condition::new(&operator.start_condition),
        invariant: Condition::new(&operator.invariant),
        end_condition: Condition::new(&operator.end_condition),
        start,
        end,
        duration: operator.duration.clone(),
        least_duration: match &operator.duration {
            None => 0.0,
            Some(
                Duration::Fixed(value) | Duration::Bounds(GroundExpression::Constant(value), _),
            ) => *value,
            Some(Duration::Bounds(..)) => 0.0,
        },
        may_overlap_itself: all()
            .any(|effect| matches!(effect.change, Change::Assign(..) | Change::Call(_))),
        kept: [
            operator.invariant.positive.clone(),
            operator.invariant.negative.clone(),
        ],
        spoils: certain_changes(&operator.end_effects),
        remembers: operator.end_effects.iter().any(|effect| {
            effect
                .condition
                .as_ref()
                .is_some_and(|c| !c[0].is_empty() || !c[1].is_empty())
        }),
    }
}

/// Sorted facts that effects certainly make false, and true.
fn certain_changes(effects: &[GroundEffect]) -> [Vec<FactId>; 2] {
    let mut changes = [Vec::new(), Vec::new()];
    for effect in effects.iter().filter(|effect| effect.condition.is_none()) {
        match effect.change {
            Change::Delete(fact) => {
                // What is added by the same happening ends up true.
                if !effects
                    .iter()
                    .any(|other| other.change == Change::Add(fact))
                {
                    changes[0].push(fact);
                }
            }
            Change::Add(fact) => changes[1].push(fact),
            Change::Assign(..) | Change::Call(_) => {}
        }
    }
    changes.iter_mut().for_each(|list| list.sort_unstable());
    changes
}

impl CompiledOperator {
    /// Whether its end certainly makes a fact false.
    #[inline]
    #[must_use]
    pub fn end_deletes(&self, fact: FactId) -> bool {
        self.spoils[0].binary_search(&fact).is_ok()
    }

    /// Whether the end of `first` certainly breaks what must hold throughout this operator.
    #[must_use]
    pub fn broken_by_end_of(&self, first: &Self) -> bool {
        meet(&self.kept[0], &first.spoils[0]) || meet(&self.kept[1], &first.spoils[1])
    }
}
