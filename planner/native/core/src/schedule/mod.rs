//! The list-schedule space: plans as lists of operators, each dispatched at its earliest start.
//!
//! ```text
//! optimiser ──► local_search ──► repair (of neighbours) ──► workshop.achieve ──► exploration
//!     │           │    │                 │    ▲                                    │
//!     │           │    └─► critical ──► links │ (what each operator is for)        └─► propositions
//!     │           └─► neighbourhood           │
//!     └─► lower_bound, construction ──────────┘
//!                                              all on: state (dispatch, undo) ──► model
//! ```
//!
//! The order of the list need not be the order of time, so there are no waits to decide on, and
//! trying a changed list takes microseconds. What the space cannot express
//! ([`Optimiser::new`] returns `None`, or required concurrency) is left to the decision-epoch
//! search.

mod application;
mod changed_list;
mod changes;
mod compilation;
mod construction;
mod critical;
mod cycle;
mod dispatch;
mod distances;
mod envelopes;
mod exchange;
mod exploration;
mod limits;
mod links;
mod local_search;
mod lower_bound;
mod model;
mod neighbourhood;
mod numbering;
mod objective;
mod optimiser;
mod promptness;
mod propositions;
mod question;
mod repair;
mod rows;
mod solution;
mod state;
mod successors;
#[cfg(test)]
mod testing;
mod windows;
mod workshop;

pub use limits::Limits;
pub use optimiser::{Ending, Optimiser};
pub use promptness::Promptness;
pub use solution::{Schedule, ScheduledOperator};
