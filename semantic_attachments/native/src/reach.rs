//! The distance to a goal when one more blockade is opened, from a field that was grown with it closed.
//!
//! Opening cells can only shorten paths, and every path that becomes shorter leaves through an opened cell: the field's values
//! around the blockade seed a search that improves them until the goal is settled.
//! Source: Ramalingam and Reps, "An incremental algorithm for a generalization of the
//! shortest-path problem", J. Algorithms 21(2), 1996 (insertions). Complexity: that of the improved cells.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::field::Field;
use crate::length::{CellMap, Length, OfField, with_lengths};
use crate::shape::{STEP_LENGTHS, Shape};
use crate::traversability::Traversability;

/// Distance and path to `goal` when `opened` (a superset of what the field was grown with) are open.
///
/// The field must have been grown on this map.
#[must_use]
pub fn reach(map: &Traversability, field: &Field, goal: u32, opened: &[usize]) -> (f64, Vec<u32>) {
    let moves = map.changed_moves(opened);
    with_lengths(
        field,
        Reach {
            field,
            moves: &moves,
            goal,
        },
    )
}

struct Reach<'a> {
    field: &'a Field,
    /// Allowed steps in and next to the opened blockades.
    moves: &'a CellMap<u8>,
    goal: u32,
}

impl OfField for Reach<'_> {
    type Answer = (f64, Vec<u32>);

    fn with<L: Length>(self, lengths: &[L], edge: impl Fn(u32, u32, usize) -> L) -> Self::Answer {
        let Self { field, moves, goal } = self;
        let offsets = field.shape.offsets();
        let allowed = |cell: u32| {
            moves
                .get(&cell)
                .copied()
                .unwrap_or_else(|| field.moves[cell as usize])
        };
        // Length and last step of the cells that have a shorter path now.
        let mut improved: CellMap<(L, u8)> = CellMap::default();
        let value = |improved: &CellMap<(L, u8)>, cell: u32| {
            improved
                .get(&cell)
                .map_or(lengths[cell as usize], |entry| entry.0)
        };
        let mut queue = BinaryHeap::new();
        for (&cell, &bits) in moves {
            let gained = bits & !field.moves[cell as usize];
            if gained != 0 && lengths[cell as usize] < L::FAR {
                queue.push(Reverse((lengths[cell as usize].key(), cell)));
            }
        }
        while let Some(Reverse((key, cell))) = queue.pop() {
            let length = value(&improved, cell);
            if key > length.key() {
                continue;
            }
            if cell == goal || length >= value(&improved, goal) {
                break;
            }
            let bits = allowed(cell);
            for (step, offset) in offsets.iter().enumerate() {
                if bits >> step & 1 == 0 {
                    continue;
                }
                let next = (cell as isize + offset) as u32;
                let reached = length + edge(cell, next, step);
                if reached < value(&improved, next) {
                    improved.insert(next, (reached, step as u8));
                    queue.push(Reverse((reached.key(), next)));
                }
            }
        }
        let length = value(&improved, goal);
        let mut path = Vec::new();
        if length < L::FAR {
            let mut cell = goal;
            while let Some((_, step)) = improved.get(&cell) {
                path.push(cell);
                cell = (cell as isize - offsets[*step as usize]) as u32;
            }
            path.extend(field.path_back(cell));
            path.reverse();
        }
        let distance = length.in_cells();
        (
            distance.unwrap_or_else(|| length_of(field.shape, &path)),
            path,
        )
    }
}

/// Length of a path in cells where all of them cost the same.
fn length_of(shape: Shape, path: &[u32]) -> f64 {
    path.windows(2)
        .map(|pair| {
            let (a, b) = (shape.row_column(pair[0]), shape.row_column(pair[1]));
            STEP_LENGTHS[if a.0 != b.0 && a.1 != b.1 { 4 } else { 0 }]
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Shape, octile};
    use proptest::prelude::*;

    const SHAPE: Shape = Shape {
        height: 12,
        width: 12,
    };

    proptest! {
        #[test]
        fn equals_a_field_grown_with_the_blockade_open(
            solid in proptest::collection::vec(proptest::bool::weighted(0.1), 144),
            blockades in proptest::collection::vec(proptest::collection::vec(0u32..144, 1..12), 2..4),
            factors in proptest::collection::vec(1.0f32..3.0, 144),
            weighted in any::<bool>(),
            radius in 0.0..1.6,
            source in 0u32..144,
            goal in 0u32..144,
        ) {
            let factors = weighted.then_some(factors);
            let map = Traversability::new(SHAPE, solid, &[false; 144], radius, factors, blockades);
            let closed = map.field(source, &[0]);
            let opened = map.field(source, &[0, 1]);
            let (distance, path) = reach(&map, &closed, goal, &[0, 1]);
            let expected = opened.distance(goal);
            prop_assert!(distance == expected || (distance - expected).abs() < 1e-9);
            prop_assert_eq!(path.is_empty(), expected.is_infinite());
            if !path.is_empty() {
                prop_assert_eq!((path[0], path[path.len() - 1]), (source, goal));
                if !weighted {
                    let length: f64 = path.windows(2)
                        .map(|pair| octile(SHAPE.row_column(pair[0]), SHAPE.row_column(pair[1])))
                        .sum();
                    prop_assert!((length - distance).abs() < 1e-9);
                }
            }
        }
    }
}
