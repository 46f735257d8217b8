//! The typed, resolved model of a PDDL 2.1 domain and problem with PDDL/M modules.
//!
//! The reader produces it, grounding and the validator consume it; every symbol is
//! resolved to an id and carries the span of the place where it was written.
//!
//! Variables are numbered by scope: an action's parameters are `0..n`, each quantifier
//! appends its own variables behind those already in scope. Evaluating a condition
//! therefore needs one stack of [`ObjectId`]s.

use crate::syntax::span::Span;

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);
        impl $name {
            /// Position in the table that this id points into.
            #[must_use]
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}

ids! {
    /// Index into [`Domain::types`]; 0 is `object`.
    TypeId,
    /// Index into [`Domain::predicates`].
    PredicateId,
    /// Index into [`Domain::functions`].
    FunctionId,
    /// Index into [`Domain::modules`].
    ModuleId,
    /// Index into [`Problem::objects`]; the domain's constants come first, in the same order.
    ObjectId,
    /// Index into [`Domain::actions`].
    ActionId,
    /// Position in the stack of bound variables.
    VariableId,
}

/// A name as written (already lower-cased, except module calls) and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// The text.
    pub text: String,
    /// Where it stands.
    pub span: Span,
}

/// A domain.
#[derive(Clone, Debug)]
pub struct Domain {
    /// `(define (domain NAME)`.
    pub name: Name,
    /// `(:requirements ...)`, with the colon.
    pub requirements: Vec<Name>,
    /// All types; index 0 is `object`.
    pub types: Vec<TypeDeclaration>,
    /// `(:constants ...)`.
    pub constants: Vec<ObjectDeclaration>,
    /// `(:predicates ...)`.
    pub predicates: Vec<PredicateDeclaration>,
    /// `(:functions ...)`; numeric only.
    pub functions: Vec<FunctionDeclaration>,
    /// `(:modules ...)` of PDDL/M.
    pub modules: Vec<ModuleDeclaration>,
    /// Durative and instantaneous actions, in the order written.
    pub actions: Vec<Action>,
    /// `(:derived ...)` rules, in the order written.
    pub derived: Vec<DerivedRule>,
    /// `(:oplinit f@lib)` of PDDL/M: called once when the actions are known.
    pub action_initialiser: Option<Name>,
}

/// A type and its direct supertypes (more than one only through `either`).
#[derive(Clone, Debug)]
pub struct TypeDeclaration {
    /// Its name.
    pub name: Name,
    /// Direct supertypes; empty only for `object`.
    pub parents: Vec<TypeId>,
}

/// A constant or object; it belongs to each of its types (`either`, or declared more than once).
#[derive(Clone, Debug)]
pub struct ObjectDeclaration {
    /// Its name.
    pub name: Name,
    /// Its types.
    pub types: Vec<TypeId>,
}

/// A parameter or quantified variable; several types mean `either`.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name, with the question mark.
    pub name: Name,
    /// Admissible types.
    pub types: Vec<TypeId>,
}

/// A predicate.
#[derive(Clone, Debug)]
pub struct PredicateDeclaration {
    /// Its name.
    pub name: Name,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Whether `(:derived ...)` rules define it.
    pub derived: bool,
}

/// A numeric function.
#[derive(Clone, Debug)]
pub struct FunctionDeclaration {
    /// Its name.
    pub name: Name,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
}

/// What an attachment computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ModuleKind {
    /// `cost`: a number, used in durations and expressions; infinite means inapplicable.
    Cost,
    /// `conditionchecker`: a truth value.
    Condition,
    /// `effect`: new values for the fluents listed.
    Effect,
}

/// An entry of `(:modules ...)`.
#[derive(Clone, Debug)]
pub struct ModuleDeclaration {
    /// The name used between square brackets.
    pub name: Name,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Fluents that an effect module writes, over the module's own parameters.
    pub writes: Vec<FluentTerm>,
    /// Its kind.
    pub kind: ModuleKind,
    /// The provider as written: `name@libfoo.so` or `name@package.module:attribute`.
    pub call: Name,
}

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

/// `(:derived (p ?x) condition)`.
#[derive(Clone, Debug)]
pub struct DerivedRule {
    /// The predicate defined.
    pub predicate: PredicateId,
    /// Its parameters: variables `0..n`.
    pub parameters: Vec<Parameter>,
    /// When it holds.
    pub condition: Condition,
    /// The whole rule.
    pub span: Span,
}

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
        }
    }
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
