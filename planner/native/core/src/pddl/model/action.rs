//! Actions, their durations and effects.

use super::condition::{Atom, Comparison, Condition, Expression, FluentTerm, ModuleCall};
use super::declaration::{Name, Parameter};
use crate::syntax::span::Span;

/// A durative or an instantaneous action.
#[derive(Clone, Debug)]
pub struct Action {
    /// Its name.
    pub name: Name,
    /// Its parameters: variables `0..n`.
    pub parameters: Vec<Parameter>,
    /// `None` for an instantaneous action; its conditions and effects then stand at [`When::Start`].
    pub duration: Option<Vec<DurationConstraint>>,
    /// Conditions, each with its time; an absent condition is an empty list.
    pub conditions: Vec<(When, Condition)>,
    /// Effects, each with its time ([`When::Start`] or [`When::End`]).
    pub effects: Vec<(When, Effect)>,
    /// The whole definition.
    pub span: Span,
}

/// The time that a condition or effect speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum When {
    /// `at start`.
    Start,
    /// `over all`: the open interval between start and end.
    OverAll,
    /// `at end`.
    End,
}

/// One conjunct of `:duration`.
#[derive(Clone, Debug)]
pub struct DurationConstraint {
    /// `=`, `<=` or `>=` (duration on the left).
    pub comparison: Comparison,
    /// Start unless written `(at end ...)`.
    pub when: When,
    /// The bound.
    pub bound: Expression,
    /// The whole conjunct.
    pub span: Span,
}

/// An effect with its place.
#[derive(Clone, Debug)]
pub struct Effect {
    /// What it does.
    pub kind: EffectKind,
    /// Where.
    pub span: Span,
}

/// The forms of an effect.
#[derive(Clone, Debug)]
pub enum EffectKind {
    /// All of them.
    And(Vec<Effect>),
    /// For all bindings.
    Forall(Vec<Parameter>, Box<Effect>),
    /// If the condition holds when the effect happens.
    When(Condition, Box<Effect>),
    /// For a durative action, a conditional effect whose conditions carry times of their own:
    /// `(when (and (at start c) (over all d)) (at end e))`.
    TimedWhen(Vec<(When, Condition)>, Box<Effect>),
    /// Makes an atom true.
    Add(Atom),
    /// Makes an atom false.
    Delete(Atom),
    /// Changes a numeric fluent.
    Assign(Assignment, FluentTerm, Expression),
    /// Calls an effect module.
    Module(ModuleCall),
}

/// How a numeric fluent changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Assignment {
    /// `assign`
    Assign,
    /// `increase`
    Increase,
    /// `decrease`
    Decrease,
    /// `scale-up`
    ScaleUp,
    /// `scale-down`
    ScaleDown,
}
