//! The decision-epoch search space: time-stamped states whose successors either start an action
//! now or let time pass to the next event.
//!
//! ```text
//! compiled    operators as bit tests, what each happening reads and writes
//! state       facts, values, running operators
//! transitions start and advance, with effects, derivation, separation of happenings
//! registry    packed states, parents, dominance between timestamps
//! successors  applicable operators
//! open_list   buckets of expanded nodes with the successors still to try
//! search      best-first search with deferred evaluation and preferred operators
//! ```
//!
//! Source: Eyerich, Mattmüller, Röger, "Using the context-enhanced additive heuristic for temporal
//! and numeric planning", ICAPS 2009. The space is incomplete where a plan needs an action to
//! start at a moment at which nothing else happens (Cushing, Kambhampati, Mausam, Weld, "When is
//! temporal planning really temporal?", IJCAI 2007); [`completeness`] says when it is complete.

pub mod alternation;
pub mod calls;
pub mod compiled;
pub mod completeness;
pub mod condition;
mod derivation;
mod effects;
pub mod happening;
pub mod open_list;
pub mod registry;
pub mod search;
mod separation;
pub mod state;
pub mod successors;
pub mod transitions;
