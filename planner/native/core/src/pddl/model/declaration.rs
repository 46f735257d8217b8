//! What a domain declares.

use super::action::Action;
use super::condition::{Condition, FluentTerm};
use super::ids::{PredicateId, TypeId};
use crate::syntax::span::Span;

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
