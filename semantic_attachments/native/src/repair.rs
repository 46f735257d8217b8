//! A field on a changed map: only the cells whose shortest paths changed are computed again.
//!
//! Source: Ramalingam and Reps, "An incremental algorithm for a generalization of the
//! shortest-path problem", J. Algorithms 21(2), 1996, for many changes at once. Complexity: `O(cells)` simple comparisons, and
//! that of Dijkstra's algorithm on the cells that changed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use crate::field::{Field, Lengths};
use crate::length::{Length, OfField, with_lengths};
use crate::shape::Shape;

/// The field as if it were grown over other `moves`, and the number of cells that were computed for it.
///
/// None where growing it anew is quicker: if the multipliers are others, or a large share of the cells is lost.
#[must_use]
pub fn repair(
    field: &Field,
    moves: Arc<Vec<u8>>,
    multiplier: Option<&Arc<Vec<f32>>>,
) -> Option<(Field, usize)> {
    let same = match (&field.multiplier, multiplier) {
        (None, None) => true,
        (Some(old), Some(new)) => Arc::ptr_eq(old, new) || old == new,
        _ => false,
    };
    if !same || field.moves.len() != moves.len() {
        return None;
    }
    let changed: Vec<u32> = (0..moves.len() as u32)
        .zip(field.moves.iter().zip(moves.iter()))
        .filter(|(_, (old, new))| old != new)
        .map(|(cell, _)| cell)
        .collect();
    let change = Change {
        shape: field.shape,
        source: field.source,
        cells: &changed,
        old: &field.moves,
        new: &moves,
    };
    let (lengths, computed) = with_lengths(field, change)?;
    let repaired = Field {
        shape: field.shape,
        source: field.source,
        lengths,
        moves,
        multiplier: field.multiplier.clone(),
    };
    Some((repaired, computed))
}

/// A field is grown anew if more than one in so many cells are lost: a queue by length takes longer a cell than a search
/// by buckets.
const MOST_LOST: usize = 12;

struct Change<'a> {
    shape: Shape,
    source: u32,
    /// Those whose allowed steps are others.
    cells: &'a [u32],
    old: &'a [u8],
    new: &'a [u8],
}

type Queue = BinaryHeap<Reverse<(u64, u32)>>;

impl OfField for Change<'_> {
    type Answer = Option<(Lengths, usize)>;

    fn with<L: Length>(self, lengths: &[L], edge: impl Fn(u32, u32, usize) -> L) -> Self::Answer {
        let (is_lost, lost) = self.lost(lengths, &edge)?;
        let mut repaired = lengths.to_vec();
        for &cell in &lost {
            repaired[cell as usize] = L::FAR;
        }
        let mut queue = Queue::new();
        for &cell in &lost {
            for (near, step) in neighbours(self.shape, self.new, cell) {
                // Steps are as long in both directions.
                let length = repaired[near as usize];
                if !is_lost[near as usize] && length < L::FAR {
                    let reached = length + edge(near, cell, step);
                    if reached < repaired[cell as usize] {
                        repaired[cell as usize] = reached;
                    }
                }
            }
            if repaired[cell as usize] < L::FAR {
                queue.push(Reverse((repaired[cell as usize].key(), cell)));
            }
        }
        for &cell in self.cells {
            let gained = self.new[cell as usize] & !self.old[cell as usize];
            if gained != 0 && !is_lost[cell as usize] && repaired[cell as usize] < L::FAR {
                queue.push(Reverse((repaired[cell as usize].key(), cell)));
            }
        }
        let mut computed = lost.len();
        while let Some(Reverse((key, cell))) = queue.pop() {
            let length = repaired[cell as usize];
            if key > length.key() {
                continue;
            }
            for (next, step) in neighbours(self.shape, self.new, cell) {
                let reached = length + edge(cell, next, step);
                if reached < repaired[next as usize] {
                    computed += usize::from(!is_lost[next as usize]);
                    repaired[next as usize] = reached;
                    queue.push(Reverse((reached.key(), next)));
                }
            }
        }
        Some((L::all(repaired), computed))
    }
}

impl Change<'_> {
    /// The cells that no old shortest path reaches any more: a flag a cell, and a list by length; none if they are many.
    fn lost<L: Length>(
        &self,
        lengths: &[L],
        edge: &impl Fn(u32, u32, usize) -> L,
    ) -> Option<(Vec<bool>, Vec<u32>)> {
        let most = lengths.len() / MOST_LOST;
        let mut is_lost = vec![false; lengths.len()];
        let mut lost = Vec::new();
        let mut queue: Queue = self
            .cells
            .iter()
            .filter(|&&cell| lengths[cell as usize] < L::FAR && cell != self.source)
            .map(|&cell| Reverse((lengths[cell as usize].key(), cell)))
            .collect();
        while let Some(Reverse((_, cell))) = queue.pop() {
            if is_lost[cell as usize] {
                continue;
            }
            let length = lengths[cell as usize];
            // Those before it are nearer to the source, so it is decided whether they are lost.
            let kept = neighbours(self.shape, self.new, cell).any(|(before, step)| {
                !is_lost[before as usize]
                    && lengths[before as usize] < length
                    && lengths[before as usize] + edge(before, cell, step) == length
            });
            if kept {
                continue;
            }
            is_lost[cell as usize] = true;
            lost.push(cell);
            if lost.len() > most {
                return None;
            }
            for (next, step) in neighbours(self.shape, self.old, cell) {
                if length + edge(cell, next, step) == lengths[next as usize] {
                    queue.push(Reverse((lengths[next as usize].key(), next)));
                }
            }
        }
        Some((is_lost, lost))
    }
}

fn neighbours(shape: Shape, moves: &[u8], cell: u32) -> impl Iterator<Item = (u32, usize)> {
    let (offsets, allowed) = (shape.offsets(), moves[cell as usize]);
    (0..8)
        .filter(move |step| allowed >> step & 1 == 1)
        .map(move |step| ((cell as isize + offsets[step]) as u32, step))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traversability::Traversability;
    use proptest::prelude::*;

    const SHAPE: Shape = Shape {
        height: 14,
        width: 11,
    };

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(800))]

        #[test]
        fn equals_a_field_grown_on_the_changed_map(
            solid in proptest::collection::vec(proptest::bool::weighted(0.15), 154),
            blockades in proptest::collection::vec(proptest::collection::vec(0u32..154, 1..12), 3),
            factors in proptest::collection::vec(1.0f32..3.0, 154),
            weighted in any::<bool>(),
            source in 0u32..154,
            (before, after) in (proptest::sample::subsequence(vec![0, 1, 2], 0..=3), proptest::sample::subsequence(vec![0, 1, 2], 0..=3)),
        ) {
            let factors = weighted.then_some(factors);
            let map = Traversability::new(SHAPE, solid, &[false; 154], 0.3, factors, blockades);
            let old = map.field(source, &before);
            let expected = map.field(source, &after);
            let repaired = repair(&old, map.moves(&after), map.multiplier.as_ref());
            prop_assert!(before != after || repaired.is_some());
            let Some((found, computed)) = repaired else { return Ok(()) };
            prop_assert!(before != after || computed == 0);
            for cell in 0..154 {
                let (found, expected) = (found.distance(cell), expected.distance(cell));
                prop_assert!(found == expected || (found - expected).abs() < 1e-9);
            }
            for cell in 0..154 {
                let path = found.path_to(cell);
                prop_assert_eq!(path.is_empty(), expected.distance(cell).is_infinite());
                prop_assert!(path.is_empty() || (path[0], path[path.len() - 1]) == (source, cell));
            }
        }
    }
}
