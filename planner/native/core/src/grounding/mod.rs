//! From the typed model to a ground task: relaxed reachability by joins, with static parts folded.
//!
//! ```text
//! ground
//!   reachability   layers of: joins over fresh atoms -> candidates -> one batch of costs -> new atoms
//!   assembly       conjunctions, effects, axioms of what was reached -> Task
//! ```
//!
//! Source: Helmert, "Concise finite-domain representations for PDDL planning tasks", Artificial
//! Intelligence 173, 2009, section 6 (relaxed reachability as a logic program).

mod assembly;
mod beam;
mod costs;
pub(crate) use costs::complaint;
mod dead_end_operators;
mod duration;
mod effect_calls;
mod formula;
mod instantiation;
mod join;
mod reachability;
mod relation;
mod relaxation;
mod relevance;
mod schema;
mod stratification;
mod token_graph;
mod tuple;
mod world;

pub use relaxation::Relaxation;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::attachment::{AttachmentError, Attachments, Purity};
use crate::invariants;
use crate::pddl::model::{Domain, ModuleId, ModuleKind, Problem};
use crate::syntax::span::Span;
use crate::task::Task;

/// What bounds grounding.
#[derive(Clone, Copy, Debug)]
pub struct GroundingLimits<'a> {
    /// Largest number of ground operators.
    pub operators: usize,
    /// Instantiations that may wait to be examined at a time; more of them make a problem too
    /// large to be grounded as a whole.
    pub candidates: usize,
    /// Largest number of disjuncts that one ground condition may split into.
    pub disjuncts: usize,
    /// When to give up.
    pub deadline: Option<Instant>,
    /// Set by somebody else to give up.
    pub cancel: Option<&'a AtomicBool>,
    /// Told of either before what was built so far is given back, which takes its time.
    pub gave_up: Option<GaveUp<'a>>,
}

/// Who is told that grounding has given up.
#[derive(Clone, Copy)]
pub struct GaveUp<'a>(pub &'a dyn Fn(&GroundingError));

impl std::fmt::Debug for GaveUp<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("GaveUp")
    }
}

impl Default for GroundingLimits<'_> {
    fn default() -> Self {
        Self {
            operators: 5_000_000,
            candidates: usize::MAX,
            disjuncts: 1_000,
            deadline: None,
            cancel: None,
            gave_up: None,
        }
    }
}

impl GroundingLimits<'_> {
    fn check(&self) -> Result<(), GroundingError> {
        let error = if self
            .cancel
            .is_some_and(|cancel| cancel.load(Ordering::Relaxed))
        {
            GroundingError::Cancelled
        } else if self
            .deadline
            .is_some_and(|deadline| Instant::now() >= deadline)
        {
            GroundingError::TimedOut
        } else {
            return Ok(());
        };
        if let Some(gave_up) = self.gave_up {
            gave_up.0(&error);
        }
        Err(error)
    }
}

/// Why a problem could not be grounded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GroundingError {
    /// An attachment failed.
    #[error(transparent)]
    Attachment(#[from] AttachmentError),
    /// A condition splits into too many conjunctions.
    #[error(
        "the condition of {action} splits into more than {limit} conjunctions; \
         move the disjunction into a derived predicate or split the action"
    )]
    TooManyDisjuncts {
        /// The action or rule.
        action: String,
        /// The limit.
        limit: usize,
        /// The action or rule, in the domain file.
        span: Span,
    },
    /// The task is too large.
    #[error(
        "the problem has more than {limit} ground actions; give parameters narrower types or add static conditions"
    )]
    TooManyOperators {
        /// The limit.
        limit: usize,
    },
    /// [`GroundingLimits::candidates`] was reached: only a part can be grounded in time.
    #[error("the problem is too large to be grounded as a whole in time")]
    TooManyCandidates,
    /// A construct that the reader accepts but the planner does not.
    #[error("{what} is not supported")]
    Unsupported {
        /// What.
        what: String,
        /// Where, in the domain file.
        span: Span,
    },
    /// Derived predicates depend negatively on themselves.
    #[error("derived predicate {predicate} depends on its own negation")]
    Unstratifiable {
        /// Which.
        predicate: String,
        /// The rule.
        span: Span,
    },
    /// The deadline passed.
    #[error("the time limit was reached while grounding")]
    TimedOut,
    /// Somebody asked to stop.
    #[error("grounding was cancelled")]
    Cancelled,
}

/// Grounds a problem.
///
/// Operators whose conditions no sequence of actions can reach (delete relaxation), whose duration
/// is undefined or whose cost attachment is infinite are left out.
///
/// # Errors
/// See [`GroundingError`].
pub fn ground(
    domain: &Domain,
    problem: &Problem,
    attachments: &dyn Attachments,
    limits: &GroundingLimits<'_>,
) -> Result<Task, GroundingError> {
    ground_with(domain, problem, attachments, limits, None)
}

/// Grounds a part of a problem: of alike facts only those that the relaxation reaches first are
/// gone on from, `width` for each object. The task says that it is partial: it proves nothing about
/// the problem.
///
/// # Errors
/// See [`GroundingError`].
pub fn ground_partially(
    domain: &Domain,
    problem: &Problem,
    attachments: &dyn Attachments,
    limits: &GroundingLimits<'_>,
    width: u32,
) -> Result<Task, GroundingError> {
    ground_with(domain, problem, attachments, limits, Some(width))
}

fn ground_with(
    domain: &Domain,
    problem: &Problem,
    attachments: &dyn Attachments,
    limits: &GroundingLimits<'_>,
    width: Option<u32>,
) -> Result<Task, GroundingError> {
    let world = world::World::new(domain, problem);
    let strata = stratification::strata(domain)?;
    let reached = match width {
        Some(width) => reachability::reach_partially(&world, attachments, limits, width)?,
        None => reachability::reach(&world, attachments, limits)?,
    };
    let stateful = (0..domain.modules.len() as u32)
        .map(ModuleId)
        .any(|module| {
            domain.modules[module.index()].kind == ModuleKind::Effect
                || attachments.purity(module) == Purity::State
        });
    let mut task = assembly::assemble(&world, reached, &strata, stateful, limits)?;
    limits.check()?;
    if !stateful {
        dead_end_operators::prune(&mut task, limits)?;
        limits.check()?;
        relevance::prune(&mut task);
    }
    task.partial = width.is_some();
    limits.check()?;
    task.mutex_groups = invariants::synthesise(&task);
    limits.check()?;
    invariants::prune_mutex_conditions(&mut task);
    Ok(task)
}
