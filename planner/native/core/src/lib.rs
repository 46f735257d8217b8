//! Temporal planning core of marsupial: reads PDDL 2.1 with PDDL/M modules,
//! grounds it, searches for plans of small makespan and validates plans.
//!
//! ```text
//! syntax ──► pddl ──► grounding ──► task ──► search, schedule ──► plan
//! (tokens,   (typed    (relaxed     (finite-domain  (two search spaces,
//!  tree,      model)    reach-       ground task)    one portfolio)
//!  spans)               ability)
//!               └────────────────────────────────────► validate  (shares no code with the search)
//! ```

pub mod analysis;
pub mod attachment;
pub mod epoch;
pub mod format;
pub mod grounding;
pub mod heuristic;
pub mod invariants;
pub mod outcome;
pub mod pddl;
pub mod plan;
pub mod portfolio;
pub mod progress;
mod report;
pub mod schedule;
pub mod sequential;
pub mod solve;
pub mod syntax;
pub mod task;
pub mod validate;
