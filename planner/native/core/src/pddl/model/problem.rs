//! A problem: objects, initial state, goal, metric.

use super::condition::{Condition, Expression};
use super::declaration::{Name, ObjectDeclaration};
use super::ids::{FunctionId, ObjectId, PredicateId};
use crate::syntax::span::Span;

/// A problem, read against its domain.
#[derive(Clone, Debug)]
pub struct Problem {
    /// `(define (problem NAME)`.
    pub name: Name,
    /// The domain's constants, then the problem's objects.
    pub objects: Vec<ObjectDeclaration>,
    /// Facts true at time 0.
    pub facts: Vec<GroundAtom>,
    /// Values of numeric fluents at time 0; an absent fluent is undefined.
    pub fluents: Vec<(GroundFluent, f64)>,
    /// Timed initial literals and assignments, `(at 5 ...)`.
    pub timed: Vec<TimedInitial>,
    /// The goal.
    pub goal: Condition,
    /// `(:metric ...)`; none means minimise total-time.
    pub metric: Option<Metric>,
    /// `(:moduleoptions (f@lib arg ...))`: the call and its arguments as written.
    pub module_options: Vec<(Name, Vec<Name>)>,
    /// `(:moduleexitoptions (f@lib arg ...))`: called with every accepted plan.
    pub module_exit_options: Vec<(Name, Vec<Name>)>,
}

/// A ground atom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroundAtom {
    /// The predicate.
    pub predicate: PredicateId,
    /// Its arguments.
    pub arguments: Vec<ObjectId>,
    /// Where it was written.
    pub span: Span,
}

/// A ground numeric fluent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroundFluent {
    /// The function.
    pub function: FunctionId,
    /// Its arguments.
    pub arguments: Vec<ObjectId>,
    /// Where it was written.
    pub span: Span,
}

/// `(at TIME literal)` or `(at TIME (= (f ...) v))`.
#[derive(Clone, Debug)]
pub struct TimedInitial {
    /// Seconds after the start, positive.
    pub time: f64,
    /// What happens then.
    pub change: TimedChange,
    /// The whole entry.
    pub span: Span,
}

/// What a timed initial literal does.
#[derive(Clone, Debug)]
pub enum TimedChange {
    /// Becomes true.
    Add(GroundAtom),
    /// Becomes false.
    Delete(GroundAtom),
    /// Gets a value.
    Assign(GroundFluent, f64),
}

/// `(:metric minimize|maximize expression)`.
#[derive(Clone, Debug)]
pub struct Metric {
    /// Whether more is better.
    pub maximise: bool,
    /// The objective.
    pub expression: Expression,
    /// The whole metric.
    pub span: Span,
}
