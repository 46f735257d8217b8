//! The delete relaxation of a temporal task: propositions and actions without deletes.
//!
//! A durative operator becomes up to two relaxed actions. The *start* gives its start effects as
//! soon as its start and over-all conditions hold; the *whole* gives its end effects after its
//! duration and needs its end conditions too. A conditional effect becomes an action of its own.
//! Propositions are facts, negated facts that something reads, and numeric comparisons. A fact
//! that ends of operators delete and others need throughout has a second proposition, *lasting*,
//! which the latter need: it lets a heuristic see that a window that is about to close is of no
//! use to an action that takes longer.

mod builder;
mod changes;
mod linear;
mod windows;

use crate::pddl::model::Assignment;
use crate::task::{FactId, FluentId, GroundExpression, NumericCondition, OperatorId, Task};

use builder::Builder;

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
    /// How it changes fluents that comparisons read: indices into [`RelaxedTask::changes`].
    pub changes: Vec<u32>,
}

impl RelaxedAction {
    /// Whether it is a rule of a derived fact, which costs nothing.
    #[inline]
    #[must_use]
    pub fn is_axiom(&self) -> bool {
        self.operator.0 == u32::MAX
    }
}

/// An action as one of its preconditions sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reader {
    /// The action.
    pub action: u32,
    /// What it adds if that is a single proposition and the action is an operator's and does
    /// nothing to numbers; else [`MANY`].
    pub only_add: Proposition,
}

/// Stands for several effects, or for some that are no propositions.
pub const MANY: Proposition = u32::MAX;

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
    /// Changes of fluents with the comparisons that they may make true, one change after the other.
    pub supports: Vec<NumericSupport>,
    /// Where the supports of each change begin and end. Actions that change a fluent alike share
    /// one, because a fluent may be read by thousands of comparisons.
    pub changes: Vec<(u32, u32)>,
    /// Number of propositions.
    pub propositions: u32,
    /// All actions.
    pub actions: Vec<RelaxedAction>,
    /// Preconditions of all actions, one after the other.
    pub preconditions: Vec<Proposition>,
    /// Where each action's preconditions begin, with a last entry for the end.
    pub precondition_offsets: Vec<u32>,
    /// What the actions make true, one after the other.
    pub adds: Vec<Proposition>,
    /// Where each action's adds begin, with a last entry for the end.
    pub add_offsets: Vec<u32>,
    /// Actions by precondition, one list after the other.
    pub readers: Vec<Reader>,
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

    /// What an action makes true.
    #[inline]
    #[must_use]
    pub fn adds_of(&self, action: u32) -> &[Proposition] {
        let range = self.add_offsets[action as usize] as usize
            ..self.add_offsets[action as usize + 1] as usize;
        &self.adds[range]
    }

    /// What an action makes or may make true, comparisons included.
    pub fn targets_of(&self, action: u32) -> impl Iterator<Item = Proposition> + '_ {
        let numeric = self.supports_of(action);
        let comparisons = numeric.map(|(_, support)| self.first_comparison + support.comparison);
        self.adds_of(action).iter().copied().chain(comparisons)
    }

    /// The comparisons that an action may make true, with their positions in [`Self::supports`].
    pub fn supports_of(&self, action: u32) -> impl Iterator<Item = (u32, &NumericSupport)> + '_ {
        let changes = self.actions[action as usize].changes.iter();
        let positions = changes.flat_map(|change| {
            let (from, to) = self.changes[*change as usize];
            from..to
        });
        positions.map(|position| (position, &self.supports[position as usize]))
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
            .map(|reader| reader.action)
            .zip(self.late[range].iter().copied())
    }

    /// The actions that a proposition is a precondition of.
    #[inline]
    #[must_use]
    pub fn readers_of(&self, proposition: Proposition) -> &[Reader] {
        let range = self.reader_offsets[proposition as usize] as usize
            ..self.reader_offsets[proposition as usize + 1] as usize;
        &self.readers[range]
    }
}
