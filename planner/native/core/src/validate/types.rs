//! Which objects belong to which types.

use crate::pddl::model::{Domain, ObjectId, Parameter, Problem, TypeId};

/// The objects of every type, in the order of declaration.
#[derive(Clone, Debug)]
pub(super) struct TypeTable {
    members: Vec<Vec<ObjectId>>,
    supertypes: Vec<Vec<bool>>,
}

impl TypeTable {
    /// Closes the hierarchy and sorts the objects into it.
    pub(super) fn new(domain: &Domain, problem: &Problem) -> Self {
        let supertypes: Vec<Vec<bool>> = (0..domain.types.len())
            .map(|index| ancestors(domain, index))
            .collect();
        let mut members = vec![Vec::new(); domain.types.len()];
        for (index, object) in problem.objects.iter().enumerate() {
            for (type_index, list) in members.iter_mut().enumerate() {
                if object
                    .types
                    .iter()
                    .any(|own| supertypes[own.index()][type_index])
                    || type_index == 0
                {
                    list.push(ObjectId(u32::try_from(index).unwrap_or(u32::MAX)));
                }
            }
        }
        Self {
            members,
            supertypes,
        }
    }

    /// The objects that may stand for a parameter.
    pub(super) fn objects_of(&self, parameter: &Parameter) -> Vec<ObjectId> {
        match parameter.types.as_slice() {
            [] => self.members.first().cloned().unwrap_or_default(),
            [only] => self.members[only.index()].clone(),
            several => {
                let mut union: Vec<_> = several
                    .iter()
                    .flat_map(|one| self.members[one.index()].iter().copied())
                    .collect();
                union.sort_unstable();
                union.dedup();
                union
            }
        }
    }

    /// Whether an object of these types may stand for the parameter.
    pub(super) fn admits(&self, parameter: &Parameter, types: &[TypeId]) -> bool {
        parameter.types.is_empty()
            || parameter.types.iter().any(|wanted| {
                wanted.index() == 0
                    || types
                        .iter()
                        .any(|own| self.supertypes[own.index()][wanted.index()])
            })
    }
}

/// Marks the type itself and everything above it.
fn ancestors(domain: &Domain, index: usize) -> Vec<bool> {
    let mut marked = vec![false; domain.types.len()];
    let mut open = vec![index];
    while let Some(next) = open.pop() {
        if !std::mem::replace(&mut marked[next], true) {
            open.extend(
                domain.types[next]
                    .parents
                    .iter()
                    .map(|parent| parent.index()),
            );
        }
    }
    marked
}
