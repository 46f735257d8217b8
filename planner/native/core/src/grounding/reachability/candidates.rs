//! Instantiations whose conditions and costs are still to be looked at.

use crate::pddl::model::ObjectId;

use super::super::{GroundingError, GroundingLimits};

/// Instantiations whose conditions and costs are still to be looked at.
pub(super) struct Candidates<'l> {
    pub(super) list: Vec<(u32, Box<[ObjectId]>)>,
    pub(super) limits: &'l GroundingLimits<'l>,
    stopped: Option<GroundingError>,
}

impl<'l> Candidates<'l> {
    /// Candidates allowed for every ground action allowed: most of them may turn out not to apply.
    const PER_OPERATOR: usize = 10;

    pub(super) fn new(limits: &'l GroundingLimits<'l>) -> Self {
        Self {
            list: Vec::new(),
            limits,
            stopped: None,
        }
    }

    /// False if the limits are reached.
    pub(super) fn add(&mut self, schema: u32, arguments: &[ObjectId]) -> bool {
        self.list.push((schema, arguments.into()));
        if self.list.len().is_multiple_of(1024) {
            self.stopped = self.limits.check().err();
        }
        let limit = self.limits.operators;
        if self.list.len() > self.limits.candidates {
            self.stopped = Some(GroundingError::TooManyCandidates);
        }
        if self.list.len() > limit.saturating_mul(Self::PER_OPERATOR) {
            self.stopped = Some(GroundingError::TooManyOperators { limit });
        }
        self.stopped.is_none()
    }

    /// Why nothing more can be added, if so.
    pub(super) fn fault(&mut self) -> Result<(), GroundingError> {
        self.stopped.take().map_or_else(|| self.limits.check(), Err)
    }
}
