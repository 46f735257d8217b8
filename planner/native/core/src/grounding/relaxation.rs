//! What a problem can reach when nothing is ever deleted, for diagnostics.

use crate::attachment::Attachments;
use crate::pddl::model::{ActionId, Domain, ObjectId, PredicateId, Problem};
use crate::task::Duration;

use super::reachability::{ImpossibleDuration, reach};
use super::relation::Relation;
use super::schema::Origin;
use super::world::World;
use super::{GroundingError, GroundingLimits};

/// Facts and actions of the delete relaxation. What it does not reach, no plan reaches.
pub struct Relaxation {
    relations: Vec<Relation>,
    applications: Vec<usize>,
    instantaneous: Vec<Option<Box<[ObjectId]>>>,
    impossible: Vec<Option<ImpossibleDuration>>,
}

impl Relaxation {
    /// Runs relaxed reachability.
    ///
    /// # Errors
    /// See [`GroundingError`].
    pub fn new(
        domain: &Domain,
        problem: &Problem,
        attachments: &dyn Attachments,
        limits: &GroundingLimits<'_>,
    ) -> Result<Self, GroundingError> {
        let world = World::new(domain, problem);
        let reached = reach(&world, attachments, limits)?;
        let mut applications = vec![0; domain.actions.len()];
        let mut instantaneous = vec![None; domain.actions.len()];
        for instance in reached.instances {
            let Origin::Action(action, _) = reached.schemas[instance.schema as usize].origin else {
                continue;
            };
            applications[action as usize] += 1;
            let zero = matches!(instance.duration, Some(Duration::Fixed(value)) if value == 0.0);
            if zero && instantaneous[action as usize].is_none() {
                instantaneous[action as usize] = Some(instance.arguments);
            }
        }
        Ok(Self {
            relations: reached.relations,
            applications,
            instantaneous,
            impossible: reached.impossible,
        })
    }

    /// Whether a fact can become true.
    #[must_use]
    pub fn reaches(&self, predicate: PredicateId, arguments: &[ObjectId]) -> bool {
        self.relations[predicate.index()].contains(arguments)
    }

    /// Number of facts of a predicate that can become true.
    #[must_use]
    pub fn facts(&self, predicate: PredicateId) -> usize {
        self.relations[predicate.index()].len()
    }

    /// Number of ground instances of an action that can apply.
    #[must_use]
    pub fn applications(&self, action: ActionId) -> usize {
        self.applications[action.index()]
    }

    /// Arguments of the first instance of a durative action that would take no time.
    #[must_use]
    pub fn without_duration(&self, action: ActionId) -> Option<&[ObjectId]> {
        self.instantaneous[action.index()].as_deref()
    }

    /// Arguments of the first instance of a durative action whose duration is negative, infinite or
    /// no number although its conditions can hold; the constraint's index and its value [s].
    #[must_use]
    pub fn impossible_duration(&self, action: ActionId) -> Option<(&[ObjectId], usize, f64)> {
        let one = self.impossible[action.index()].as_ref()?;
        Some((&one.arguments, one.constraint, one.value_s))
    }
}
