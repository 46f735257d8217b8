//! Operators prepared for search: bit tests for conditions, reads and writes of each happening.

use crate::pddl::model::{Assignment, Comparison};
use crate::plan::EPSILON;
use crate::task::{
    CallId, Change, Conjunction, Duration, FactId, FluentId, GroundEffect, GroundExpression,
    NumericCondition, Operator, OperatorId, Task,
};

/// A conjunction as masks over the words of a fact set that it touches.
#[derive(Clone, Debug, Default)]
pub struct Condition {
    /// `(word, bits that must be one, bits that must be zero)`.
    masks: Vec<(u32, u64, u64)>,
    /// Numeric comparisons.
    pub comparisons: Vec<NumericCondition>,
    /// State-dependent condition attachments.
    pub calls: Vec<(CallId, bool)>,
}

impl Condition {
    /// Compiles a conjunction.
    #[must_use]
    pub fn new(conjunction: &Conjunction) -> Self {
        let mut masks: Vec<(u32, u64, u64)> = Vec::new();
        let mut mark = |fact: FactId, positive: bool| {
            let (word, bit) = (fact.0 / 64, 1_u64 << (fact.0 % 64));
            let position = masks.iter().position(|mask| mask.0 == word);
            let position = position.unwrap_or_else(|| {
                masks.push((word, 0, 0));
                masks.len() - 1
            });
            if positive {
                masks[position].1 |= bit;
            } else {
                masks[position].2 |= bit;
            }
        };
        conjunction.positive.iter().for_each(|&f| mark(f, true));
        conjunction.negative.iter().for_each(|&f| mark(f, false));
        Self {
            masks,
            comparisons: conjunction.comparisons.clone(),
            calls: conjunction.calls.clone(),
        }
    }

    /// Whether it is trivially true.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.masks.is_empty() && self.comparisons.is_empty() && self.calls.is_empty()
    }

    /// Whether the literals hold in a fact set.
    #[inline]
    #[must_use]
    pub fn literals_hold(&self, facts: &[u64]) -> bool {
        self.masks.iter().all(|&(word, ones, zeros)| {
            let bits = facts[word as usize];
            bits & ones == ones && bits & zeros == 0
        })
    }
}

/// What an effect changes, with its compiled condition.
#[derive(Clone, Debug)]
pub struct Effect {
    /// Conditions at start, throughout and when it happens.
    pub condition: Option<Box<[Condition; 3]>>,
    /// The change.
    pub change: Change,
}

/// One end of an action: what it reads, what it writes.
#[derive(Clone, Debug, Default)]
pub struct Happening {
    /// Effects, deletes first.
    pub effects: Vec<Effect>,
    reads: Vec<FactId>,
    adds: Vec<FactId>,
    deletes: Vec<FactId>,
    fluent_reads: Vec<FluentId>,
    fluent_writes: Vec<(FluentId, bool)>,
    /// Attachments may read and write anything.
    opaque: bool,
    /// Reads a derived fact; writes a fact that derived ones depend on.
    derived: (bool, bool),
}

impl Happening {
    fn of(task: &Task, condition: &Conjunction, effects: &[GroundEffect]) -> Self {
        let mut happening = Self::default();
        happening.read(condition);
        for effect in effects {
            if let Some(conditions) = &effect.condition {
                happening.read(&conditions[2]);
                happening.read(&conditions[0]);
            }
            match &effect.change {
                Change::Add(fact) => happening.adds.push(*fact),
                Change::Delete(fact) => happening.deletes.push(*fact),
                Change::Assign(assignment, fluent, value) => {
                    let additive =
                        matches!(assignment, Assignment::Increase | Assignment::Decrease);
                    happening.fluent_writes.push((*fluent, additive));
                    happening.read_expression(value);
                }
                Change::Call(call) => {
                    happening.opaque = true;
                    for fluent in &task.calls[call.index()].writes {
                        happening.fluent_writes.push((*fluent, false));
                    }
                }
            }
        }
        for list in [
            &mut happening.reads,
            &mut happening.adds,
            &mut happening.deletes,
        ] {
            list.sort_unstable();
            list.dedup();
        }
        happening.effects = compile_effects(effects);
        if !task.axioms.is_empty() {
            let heads = |fact: &FactId| task.axioms.iter().any(|axiom| axiom.head == *fact);
            happening.derived.0 = happening.reads.iter().any(heads);
            let numeric = |axiom: &crate::task::Axiom| {
                !axiom.condition.comparisons.is_empty() || !axiom.condition.calls.is_empty()
            };
            happening.derived.1 = !happening.adds.is_empty()
                || !happening.deletes.is_empty()
                || (!happening.fluent_writes.is_empty() && task.axioms.iter().any(numeric));
        }
        happening
    }

    fn read(&mut self, condition: &Conjunction) {
        self.reads.extend(&condition.positive);
        self.reads.extend(&condition.negative);
        for comparison in &condition.comparisons {
            self.read_expression(&comparison.left);
            self.read_expression(&comparison.right);
        }
        self.opaque |= !condition.calls.is_empty();
    }

    fn read_expression(&mut self, expression: &GroundExpression) {
        match expression {
            GroundExpression::Fluent(fluent) => self.fluent_reads.push(*fluent),
            GroundExpression::Binary(_, left, right) => {
                self.read_expression(left);
                self.read_expression(right);
            }
            GroundExpression::Call(_) => self.opaque = true,
            GroundExpression::Constant(_)
            | GroundExpression::Duration
            | GroundExpression::TotalTime => {}
        }
    }

    fn writes_something(&self) -> bool {
        !(self.adds.is_empty() && self.deletes.is_empty() && self.fluent_writes.is_empty())
    }

    /// Whether two happenings must not stand closer than [`EPSILON`] (PDDL 2.1, definition 12).
    #[must_use]
    pub fn interferes(&self, other: &Self) -> bool {
        if (self.opaque && other.writes_something()) || (other.opaque && self.writes_something()) {
            return true;
        }
        if (self.derived.0 && other.derived.1) || (other.derived.0 && self.derived.1) {
            return true;
        }
        if meet(&self.reads, &other.adds)
            || meet(&self.reads, &other.deletes)
            || meet(&other.reads, &self.adds)
            || meet(&other.reads, &self.deletes)
            || meet(&self.adds, &other.deletes)
            || meet(&other.adds, &self.deletes)
        {
            return true;
        }
        let numeric = |left: &Self, right: &Self| {
            left.fluent_writes.iter().any(|(fluent, additive)| {
                right.fluent_reads.contains(fluent)
                    || right
                        .fluent_writes
                        .iter()
                        .any(|(other, also)| other == fluent && !(*additive && *also))
            })
        };
        numeric(self, other) || numeric(other, self)
    }
}

/// Whether two sorted lists share an element.
fn meet(left: &[FactId], right: &[FactId]) -> bool {
    let (mut i, mut j) = (0, 0);
    while i < left.len() && j < right.len() {
        match left[i].cmp(&right[j]) {
            std::cmp::Ordering::Less => i += 1,
            std::cmp::Ordering::Greater => j += 1,
            std::cmp::Ordering::Equal => return true,
        }
    }
    false
}

fn compile_effects(effects: &[GroundEffect]) -> Vec<Effect> {
    let mut compiled: Vec<Effect> = effects
        .iter()
        .map(|effect| Effect {
            condition: effect.condition.as_ref().map(|conditions| {
                Box::new([
                    Condition::new(&conditions[0]),
                    Condition::new(&conditions[1]),
                    Condition::new(&conditions[2]),
                ])
            }),
            change: effect.change.clone(),
        })
        .collect();
    compiled.sort_by_key(|effect| !matches!(effect.change, Change::Delete(_)));
    compiled
}

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
        let mut derived: Vec<FactId> = task.axioms.iter().map(|axiom| axiom.head).collect();
        derived.sort_unstable();
        derived.dedup();
        Self {
            task,
            words: task.facts.len().div_ceil(64),
            operators: task
                .operators
                .iter()
                .map(|operator| compile(task, operator))
                .collect(),
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

/// The value of an expression; NaN where it is undefined. `call` supplies attachments.
pub fn evaluate(
    expression: &GroundExpression,
    values: &[f64],
    duration: f64,
    total_time: f64,
    call: &mut dyn FnMut(CallId) -> f64,
) -> f64 {
    match expression {
        GroundExpression::Constant(value) => *value,
        GroundExpression::Fluent(fluent) => values[fluent.index()],
        GroundExpression::Duration => duration,
        GroundExpression::TotalTime => total_time,
        GroundExpression::Call(id) => call(*id),
        GroundExpression::Binary(operation, left, right) => {
            let left = evaluate(left, values, duration, total_time, call);
            let right = evaluate(right, values, duration, total_time, call);
            operation.apply(left, right)
        }
    }
}

/// Whether a comparison holds; false where a side is undefined.
pub fn comparison_holds(
    condition: &NumericCondition,
    values: &[f64],
    duration: f64,
    call: &mut dyn FnMut(CallId) -> f64,
) -> bool {
    let left = evaluate(&condition.left, values, duration, 0.0, call);
    let right = evaluate(&condition.right, values, duration, 0.0, call);
    let comparison: Comparison = condition.comparison;
    comparison.holds(left, right)
}

/// Two happenings closer than this count as simultaneous for interference.
#[must_use]
pub fn too_close(left: f64, right: f64) -> bool {
    (left - right).abs() < EPSILON * (1.0 - 1e-6)
}
