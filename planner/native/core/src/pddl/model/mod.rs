//! The typed, resolved model of a PDDL 2.1 domain and problem with PDDL/M modules.
//!
//! The reader produces it, grounding and the validator consume it; every symbol is
//! resolved to an id and carries the span of the place where it was written.
//!
//! Variables are numbered by scope: an action's parameters are `0..n`, each quantifier
//! appends its own variables behind those already in scope. Evaluating a condition
//! therefore needs one stack of [`ObjectId`]s.

mod action;
mod condition;
mod declaration;
mod ids;
mod problem;
mod spelling;

pub use action::*;
pub use condition::*;
pub use declaration::*;
pub use ids::*;
pub use problem::*;
