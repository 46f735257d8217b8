//! Terms, conditions and numeric expressions.

use super::declaration::Parameter;
use super::ids::{FunctionId, ModuleId, ObjectId, PredicateId, VariableId};
use crate::syntax::span::Span;

/// A variable or an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Term {
    /// A bound variable.
    Variable(VariableId),
    /// A constant or object.
    Object(ObjectId),
}

/// `(p t1 ... tn)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Atom {
    /// The predicate.
    pub predicate: PredicateId,
    /// Its arguments.
    pub arguments: Vec<Term>,
    /// The whole atom.
    pub span: Span,
}

/// `(f t1 ... tn)` of a numeric function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FluentTerm {
    /// The function.
    pub function: FunctionId,
    /// Its arguments.
    pub arguments: Vec<Term>,
    /// The whole term.
    pub span: Span,
}

/// `[m t1 ... tn]`, the call of an attachment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModuleCall {
    /// The module.
    pub module: ModuleId,
    /// Its arguments.
    pub arguments: Vec<Term>,
    /// The call with its brackets.
    pub span: Span,
}

/// A condition with its place.
#[derive(Clone, Debug)]
pub struct Condition {
    /// What it says.
    pub kind: ConditionKind,
    /// Where.
    pub span: Span,
}

/// The forms of a condition.
#[derive(Clone, Debug)]
pub enum ConditionKind {
    /// All hold; the empty conjunction is true.
    And(Vec<Condition>),
    /// At least one holds; the empty disjunction is false.
    Or(Vec<Condition>),
    /// Does not hold.
    Not(Box<Condition>),
    /// If the first holds, so does the second.
    Imply(Box<Condition>, Box<Condition>),
    /// Holds for all bindings.
    Forall(Vec<Parameter>, Box<Condition>),
    /// Holds for some binding.
    Exists(Vec<Parameter>, Box<Condition>),
    /// A predicate holds.
    Atom(Atom),
    /// Two terms name the same object.
    Equal(Term, Term),
    /// A numeric comparison.
    Compare(Comparison, Expression, Expression),
    /// A condition checker holds.
    Module(ModuleCall),
}

/// A numeric comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `=`
    Equal,
    /// `>=`
    GreaterEqual,
    /// `>`
    Greater,
}

impl Comparison {
    /// Whether it holds between two numbers; false where one is NaN (undefined).
    #[must_use]
    pub fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Self::Less => left < right,
            Self::LessEqual => left <= right,
            Self::Equal => left == right,
            Self::GreaterEqual => left >= right,
            Self::Greater => left > right,
        }
    }
}

/// A numeric expression with its place.
#[derive(Clone, Debug)]
pub struct Expression {
    /// What it computes.
    pub kind: ExpressionKind,
    /// Where.
    pub span: Span,
}

/// The forms of a numeric expression.
#[derive(Clone, Debug)]
pub enum ExpressionKind {
    /// A literal.
    Number(f64),
    /// A numeric fluent.
    Fluent(FluentTerm),
    /// A cost module.
    Module(ModuleCall),
    /// `?duration` of the enclosing durative action.
    Duration,
    /// `total-time` (metric only).
    TotalTime,
    /// `(+ a b ...)`, `(- a b)`, `(* a b ...)`, `(/ a b)`, folded to the left.
    Binary(Arithmetic, Box<Expression>, Box<Expression>),
    /// `(- a)`.
    Negate(Box<Expression>),
}

/// An arithmetic operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Arithmetic {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
    /// The smaller one; no PDDL operator, made where a duration has several upper bounds.
    Minimum,
    /// The larger one; no PDDL operator, made where a duration has several lower bounds.
    Maximum,
}

impl Arithmetic {
    /// The result on two numbers.
    #[must_use]
    pub fn apply(self, left: f64, right: f64) -> f64 {
        match self {
            Self::Add => left + right,
            Self::Subtract => left - right,
            Self::Multiply => left * right,
            Self::Divide => left / right,
            // Unlike `f64::min`, an undefined operand makes the result undefined.
            Self::Minimum | Self::Maximum if left.is_nan() || right.is_nan() => f64::NAN,
            Self::Minimum => left.min(right),
            Self::Maximum => left.max(right),
        }
    }
}

impl Comparison {
    /// The comparison with its sides exchanged: `a < b` is `b > a`.
    #[must_use]
    pub const fn mirrored(self) -> Self {
        match self {
            Self::Less => Self::Greater,
            Self::LessEqual => Self::GreaterEqual,
            Self::Equal => Self::Equal,
            Self::GreaterEqual => Self::LessEqual,
            Self::Greater => Self::Less,
        }
    }
}
