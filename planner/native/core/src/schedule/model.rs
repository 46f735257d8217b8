//! A ground task in the flat form that dispatching and relaxed exploration walk over.

use crate::pddl::model::Assignment;
use crate::task::{Conjunction, FluentId, GroundExpression, NumericCondition};

/// Least separation of two happenings that interfere [s] (PDDL 2.1).
pub const EPSILON: f64 = 0.001;

/// Stands for "no such index".
pub const NONE: u32 = u32::MAX;

/// When a condition has to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Just before the start.
    Start,
    /// Between start and end.
    Throughout,
    /// Just before the end.
    End,
}

/// A literal that an operator needs.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    pub fact: u32,
    pub value: bool,
    pub when: When,
    /// The operator's own start effect supplies it.
    pub own: bool,
}

/// A literal that an operator makes true.
#[derive(Clone, Copy, Debug)]
pub struct Write {
    pub fact: u32,
    pub value: bool,
    pub at_end: bool,
    /// The operator writes the same fact at its start too.
    pub after_own: bool,
}

/// A change of a fluent.
#[derive(Clone, Debug)]
pub struct NumericWrite {
    pub assignment: Assignment,
    pub fluent: FluentId,
    pub value: GroundExpression,
    pub at_end: bool,
    /// Fluents that `value` reads.
    pub reads: Vec<u32>,
}

impl NumericWrite {
    /// Whether simultaneous changes commute.
    pub fn additive(&self) -> bool {
        matches!(self.assignment, Assignment::Increase | Assignment::Decrease)
    }
}

/// A comparison, when it has to hold and the fluents it reads.
#[derive(Clone, Debug)]
pub struct Comparing {
    pub condition: NumericCondition,
    pub when: When,
    pub reads: Vec<u32>,
}

/// An effect that depends on the state.
#[derive(Clone, Debug)]
pub struct ConditionalWrite {
    pub condition: [Conjunction; 3],
    pub at_end: bool,
    pub fact: Option<(u32, bool)>,
    pub fluent: Option<NumericWrite>,
}

/// What few operators have.
#[derive(Clone, Debug, Default)]
pub struct Detail {
    pub bounds: Option<(GroundExpression, GroundExpression, Vec<u32>)>,
    pub comparisons: Vec<Comparing>,
    pub numeric: Vec<NumericWrite>,
    pub conditional: Vec<ConditionalWrite>,
    /// Facts that a condition at the start (at the end, if true) mentions without depending on
    /// them: no writer of them may happen at the same moment.
    pub mentions: Vec<(u32, bool)>,
}

/// An operator's slices of the tables.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Fixed duration [s]; NaN if it depends on the state.
    pub duration: f64,
    pub reads: (u32, u32),
    pub writes: (u32, u32),
    /// Index into [`Model::details`] or [`NONE`].
    pub detail: u32,
    pub instantaneous: bool,
    /// Left out: it can never run in this space.
    pub excluded: bool,
    /// All it achieves are windows: facts that hold only while it runs.
    pub envelope: bool,
}

/// The compiled task.
#[derive(Clone, Debug)]
pub struct Model {
    pub fact_count: usize,
    pub initial_facts: Vec<bool>,
    pub initial_values: Vec<f64>,
    pub shapes: Vec<Shape>,
    pub reads: Vec<Read>,
    pub writes: Vec<Write>,
    pub details: Vec<Detail>,
    /// Facts with past windows a reader may use; index into the state's windows or [`NONE`].
    pub window_of: Vec<u32>,
    /// The facts with windows.
    pub windowed: Vec<u32>,
    /// For how long operators open each of them, sorted [s].
    pub window_lengths: Vec<Vec<f64>>,
    pub goal: Vec<(u32, bool)>,
    pub goal_comparisons: Vec<Comparing>,
    /// What the goal wants of each fact.
    pub goal_value: Vec<Option<bool>>,
    /// Operators that write a goal fact the wrong way.
    pub threatens_goal: Vec<bool>,
    /// Whether an operator can make the fact false (true).
    pub deletable: Vec<bool>,
    /// Whether operators that may be part of a plan were left out.
    pub excluded_any: bool,
}

/// Fluents that an expression reads; `None` if it calls an attachment.
pub fn fluents_of(expression: &GroundExpression, out: &mut Vec<u32>) -> Option<()> {
    match expression {
        GroundExpression::Constant(_)
        | GroundExpression::Duration
        | GroundExpression::TotalTime => Some(()),
        GroundExpression::Fluent(fluent) => {
            out.push(fluent.0);
            Some(())
        }
        GroundExpression::Call(_) => None,
        GroundExpression::Binary(_, left, right) => {
            fluents_of(left, out)?;
            fluents_of(right, out)
        }
    }
}

impl Model {
    /// Literals that an operator needs.
    pub fn reads(&self, operator: u32) -> &[Read] {
        let (from, to) = self.shapes[operator as usize].reads;
        &self.reads[from as usize..to as usize]
    }

    /// Literals that an operator writes whatever the state.
    pub fn writes(&self, operator: u32) -> &[Write] {
        let (from, to) = self.shapes[operator as usize].writes;
        &self.writes[from as usize..to as usize]
    }

    /// Numeric and conditional parts of an operator.
    pub fn detail(&self, operator: u32) -> Option<&Detail> {
        self.details
            .get(self.shapes[operator as usize].detail as usize)
    }
}

/// Literals of a conjunction as (fact, value).
pub fn literals(condition: &Conjunction) -> impl Iterator<Item = (u32, bool)> + '_ {
    let positive = condition.positive.iter().map(|fact| (fact.0, true));
    positive.chain(condition.negative.iter().map(|fact| (fact.0, false)))
}

/// Visits the facts and fluents that a conditional effect reads, with the part that reads them.
pub fn for_reads(condition: &[Conjunction; 3], mut visit: impl FnMut(usize, Option<u32>, &[u32])) {
    for (index, part) in condition.iter().enumerate() {
        for (fact, _) in literals(part) {
            visit(index, Some(fact), &[]);
        }
        for comparison in &part.comparisons {
            let mut fluents = Vec::new();
            let _ = fluents_of(&comparison.left, &mut fluents);
            let _ = fluents_of(&comparison.right, &mut fluents);
            visit(index, None, &fluents);
        }
    }
}
