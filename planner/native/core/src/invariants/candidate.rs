//! Candidates for invariants.

use crate::pddl::model::{ObjectId, PredicateId};

/// A predicate of a candidate.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Part {
    /// The predicate.
    pub(super) predicate: PredicateId,
    /// The argument that may be anything.
    pub(super) counted: Option<usize>,
    /// Positions of the arguments that identify the group, in the order of the candidate's key.
    pub(super) fixed: Vec<usize>,
}

/// Predicates whose facts are counted together.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Candidate {
    /// Sorted, at most one a predicate.
    pub(super) parts: Vec<Part>,
}

impl Candidate {
    pub(super) fn new(part: Part) -> Self {
        Self { parts: vec![part] }
    }

    /// The objects that identify the group of a fact; `None` if it is in none.
    pub(super) fn key(
        &self,
        predicate: PredicateId,
        arguments: &[ObjectId],
    ) -> Option<Vec<ObjectId>> {
        let part = self.parts.iter().find(|part| part.predicate == predicate)?;
        Some(part.fixed.iter().map(|&p| arguments[p]).collect())
    }

    /// The candidate with one more predicate, such that a fact of it falls into the group of a key.
    pub(super) fn extended(
        &self,
        predicate: PredicateId,
        arguments: &[ObjectId],
        key: &[ObjectId],
    ) -> Option<Self> {
        if self.parts.iter().any(|part| part.predicate == predicate) {
            return None;
        }
        let mut fixed = Vec::with_capacity(key.len());
        for object in key {
            let position =
                (0..arguments.len()).find(|&p| arguments[p] == *object && !fixed.contains(&p))?;
            fixed.push(position);
        }
        let mut others = (0..arguments.len()).filter(|p| !fixed.contains(p));
        let counted = others.next();
        if others.next().is_some() {
            return None;
        }
        let mut parts = self.parts.clone();
        parts.push(Part {
            predicate,
            counted,
            fixed,
        });
        parts.sort();
        Some(Self { parts })
    }
}
