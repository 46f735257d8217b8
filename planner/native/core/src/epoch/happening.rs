//! Happenings: what they read and write, and which of them must be kept apart.

use crate::pddl::model::Assignment;
use crate::plan::EPSILON;
use crate::task::{Change, Conjunction, FactId, FluentId, GroundEffect, GroundExpression, Task};

use super::condition::Condition;

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
    pub(super) reads: Vec<FactId>,
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
    pub(super) fn of(task: &Task, condition: &Conjunction, effects: &[GroundEffect]) -> Self {
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

    pub(super) fn read(&mut self, condition: &Conjunction) {
        self.reads.extend(&condition.positive);
        self.reads.extend(&condition.negative);
        for comparison in &condition.comparisons {
            self.read_expression(&comparison.left);
            self.read_expression(&comparison.right);
        }
        self.opaque |= !condition.calls.is_empty();
    }

    pub(super) fn read_expression(&mut self, expression: &GroundExpression) {
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
pub(super) fn meet(left: &[FactId], right: &[FactId]) -> bool {
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

/// Two happenings closer than this count as simultaneous for interference.
#[must_use]
pub fn too_close(left: f64, right: f64) -> bool {
    (left - right).abs() < EPSILON * (1.0 - 1e-6)
}
