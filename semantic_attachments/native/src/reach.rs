//! The distance to a goal when one more blockade is opened, from a field that was grown with it closed.
//!
//! Opening cells can only shorten paths, and every path that becomes shorter leaves through an opened cell: the field's values
//! around the blockade seed a search that improves them until the goal is settled.
//! Source: Ramalingam and Reps, "An incremental algorithm for a generalization of the
//! shortest-path problem", J. Algorithms 21(2), 1996 (insertions). Complexity: that of the improved cells.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use crate::one_to_all::{Field, NO_STEP, mean_factor};
use crate::shape::STEP_LENGTHS;
use crate::traversability::Traversability;

/// Distance and path to `goal` when `opened` (a superset of what the field was grown with) are open.
#[must_use]
pub fn reach(map: &Traversability, field: &Field, goal: u32, opened: &[usize]) -> (f64, Vec<u32>) {
    let moves = map.changed_moves(opened);
    let offsets = field.shape.offsets();
    let mut improved: HashMap<u32, (f64, u8)> = HashMap::new();
    let value = |improved: &HashMap<u32, (f64, u8)>, cell: u32| {
        improved
            .get(&cell)
            .map_or(field.distances[cell as usize], |entry| entry.0)
    };
    let mut seeds: Vec<u32> = moves
        .keys()
        .copied()
        .filter(|&cell| field.distances[cell as usize].is_finite())
        .collect();
    seeds.sort_unstable();
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> = seeds
        .into_iter()
        .map(|cell| Reverse((field.distances[cell as usize].to_bits(), cell)))
        .collect();
    while let Some(Reverse((bits, cell))) = queue.pop() {
        let distance = f64::from_bits(bits);
        if distance > value(&improved, cell) {
            continue;
        }
        if cell == goal || distance >= value(&improved, goal) {
            break;
        }
        let allowed = moves
            .get(&cell)
            .copied()
            .unwrap_or(map.closed_moves()[cell as usize]);
        for (step, length) in STEP_LENGTHS.iter().enumerate() {
            if allowed >> step & 1 == 0 {
                continue;
            }
            let next = (cell as isize + offsets[step]) as u32;
            let factor = map
                .multiplier
                .as_ref()
                .map_or(1.0, |m| mean_factor(m, cell as usize, next as usize));
            let reached = distance + length * factor;
            if reached < value(&improved, next) {
                improved.insert(next, (reached, step as u8));
                queue.push(Reverse((reached.to_bits(), next)));
            }
        }
    }
    let distance = value(&improved, goal);
    if distance.is_infinite() {
        return (distance, Vec::new());
    }
    let mut path = vec![goal];
    let mut cell = goal;
    loop {
        let step = improved
            .get(&cell)
            .map_or(field.steps[cell as usize], |entry| entry.1);
        if step == NO_STEP {
            break;
        }
        cell = (cell as isize - offsets[step as usize]) as u32;
        path.push(cell);
    }
    path.reverse();
    (distance, path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::one_to_all::one_to_all;
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
            let multiplier = map.multiplier.as_deref();
            let closed = one_to_all(SHAPE, &map.moves(&[0]), multiplier, source);
            let opened = one_to_all(SHAPE, &map.moves(&[0, 1]), multiplier, source);
            let (distance, path) = reach(&map, &closed, goal, &[0, 1]);
            let expected = opened.distances[goal as usize];
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
