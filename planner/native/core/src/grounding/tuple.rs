//! Arguments under bindings: looked up far more often than kept, so usually not on the heap.

use std::ops::Deref;

use crate::pddl::model::ObjectId;

/// Arguments that fit in place.
const FEW: usize = 6;

/// The arguments of a ground atom, fluent or call.
#[derive(Clone, Debug)]
pub(super) enum Tuple {
    /// So many of them, in place.
    Few(usize, [ObjectId; FEW]),
    /// More.
    Many(Box<[ObjectId]>),
}

impl<I: ExactSizeIterator<Item = ObjectId>> From<I> for Tuple {
    fn from(objects: I) -> Self {
        if objects.len() > FEW {
            return Self::Many(objects.collect());
        }
        let mut few = [ObjectId(0); FEW];
        let mut length = 0;
        for (slot, object) in few.iter_mut().zip(objects) {
            *slot = object;
            length += 1;
        }
        Self::Few(length, few)
    }
}

impl Deref for Tuple {
    type Target = [ObjectId];

    fn deref(&self) -> &[ObjectId] {
        match self {
            Self::Few(length, few) => &few[..*length],
            Self::Many(many) => many,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tuple_of_any_length_is_what_it_was_made_from() {
        for length in 0..2 * FEW as u32 {
            let objects: Vec<ObjectId> = (0..length).map(|object| ObjectId(object * 7)).collect();
            assert_eq!(*Tuple::from(objects.iter().copied()), *objects);
        }
    }
}
