//! Distances from one cell to all others: Dijkstra's algorithm with buckets.
//!
//! Source: Denardo and Fox, "Shortest-route methods: 1. Reaching, pruning, and buckets", Operations
//! Research 27(1), 1979. No edge is shorter than one bucket is wide, so the cells of a bucket may be settled in any
//! order and the distances are exact; a queue operation costs a constant.
//! Complexity: `O(cells + longest distance)`.

use crate::shape::{STEP_LENGTHS, Shape};

/// Direction of a cell that has no predecessor: the source, or a cell out of reach.
pub const NO_STEP: u8 = 8;

/// The shortest-path tree of one source.
#[derive(Clone, Debug)]
pub struct Field {
    /// Rows and columns.
    pub shape: Shape,
    /// The cell the distances are from.
    pub source: u32,
    /// Distance of each cell, in cells times multiplier; infinite where there is no path.
    pub distances: Vec<f64>,
    /// The step that led into each cell, or [`NO_STEP`].
    pub steps: Vec<u8>,
}

impl Field {
    /// The cells from the source to a goal, or nothing if there is no path.
    #[must_use]
    pub fn path_to(&self, goal: u32) -> Vec<u32> {
        if self.distances[goal as usize].is_infinite() {
            return Vec::new();
        }
        let offsets = self.shape.offsets();
        let mut path = vec![goal];
        let mut cell = goal;
        while self.steps[cell as usize] != NO_STEP {
            cell = (cell as isize - offsets[self.steps[cell as usize] as usize]) as u32;
            path.push(cell);
        }
        path.reverse();
        path
    }
}

/// Grows the shortest-path tree of `source` over the allowed `moves`.
///
/// `multiplier` scales the length of a step by the mean of its two cells; each must be at least 1.
#[must_use]
pub fn one_to_all(shape: Shape, moves: &[u8], multiplier: Option<&[f32]>, source: u32) -> Field {
    match multiplier {
        None => grow(
            shape,
            moves,
            source,
            std::f64::consts::SQRT_2,
            |_, _, step| STEP_LENGTHS[step],
        ),
        Some(factors) => {
            let largest = f64::from(factors.iter().copied().fold(1.0, f32::max));
            grow(
                shape,
                moves,
                source,
                largest * std::f64::consts::SQRT_2,
                |from, to, step| STEP_LENGTHS[step] * mean_factor(factors, from, to),
            )
        }
    }
}

/// Mean multiplier of two cells.
#[must_use]
pub fn mean_factor(factors: &[f32], from: usize, to: usize) -> f64 {
    0.5 * (f64::from(factors[from]) + f64::from(factors[to]))
}

fn grow(
    shape: Shape,
    moves: &[u8],
    source: u32,
    longest_edge: f64,
    length: impl Fn(usize, usize, usize) -> f64,
) -> Field {
    let mut distances = vec![f64::INFINITY; shape.len()];
    let mut steps = vec![NO_STEP; shape.len()];
    let offsets = shape.offsets();
    let mut buckets: Vec<Vec<u32>> = vec![Vec::new(); longest_edge.ceil() as usize + 2];
    let ring = buckets.len() as u64;
    distances[source as usize] = 0.0;
    buckets[0].push(source);
    let mut waiting = 1_usize;
    let mut number = 0_u64;
    let mut settling = Vec::new();
    while waiting > 0 {
        let slot = (number % ring) as usize;
        std::mem::swap(&mut settling, &mut buckets[slot]);
        waiting -= settling.len();
        for &cell in &settling {
            let from = cell as usize;
            let distance = distances[from];
            if distance as u64 != number {
                continue; // a shorter path settled it in an earlier bucket
            }
            let mut open = moves[from];
            while open != 0 {
                let step = open.trailing_zeros() as usize;
                open &= open - 1;
                let to = (from as isize + offsets[step]) as usize;
                let reached = distance + length(from, to, step);
                if reached < distances[to] {
                    distances[to] = reached;
                    steps[to] = step as u8;
                    buckets[(reached as u64 % ring) as usize].push(to as u32);
                    waiting += 1;
                }
            }
        }
        settling.clear();
        number += 1;
    }
    Field {
        shape,
        source,
        distances,
        steps,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::moves::all_moves;
    use proptest::prelude::*;

    /// Bellman-Ford: relaxes all edges until nothing changes.
    fn by_relaxation(shape: Shape, moves: &[u8], factors: &[f32], source: u32) -> Vec<f64> {
        let mut distances = vec![f64::INFINITY; shape.len()];
        distances[source as usize] = 0.0;
        loop {
            let before = distances.clone();
            for cell in 0..shape.len() as u32 {
                for (step, length) in STEP_LENGTHS.iter().enumerate() {
                    if moves[cell as usize] >> step & 1 == 1 {
                        let to = shape.neighbour(cell, step).unwrap() as usize;
                        let factor = mean_factor(factors, cell as usize, to);
                        distances[to] =
                            distances[to].min(distances[cell as usize] + length * factor);
                    }
                }
            }
            if before == distances {
                return distances;
            }
        }
    }

    #[test]
    fn an_empty_grid_has_octile_distances() {
        let shape = Shape {
            height: 20,
            width: 30,
        };
        let moves = all_moves(shape, &vec![true; shape.len()]);
        let source = shape.cell(7, 11).unwrap();
        let field = one_to_all(shape, &moves, None, source);
        for cell in 0..shape.len() as u32 {
            let expected = crate::shape::octile(shape.row_column(cell), (7, 11));
            assert!((field.distances[cell as usize] - expected).abs() < 1e-9);
            assert_eq!(field.path_to(cell).first(), Some(&source));
        }
    }

    proptest! {
        #[test]
        fn equals_relaxation_on_random_grids(
            passable in proptest::collection::vec(proptest::bool::weighted(0.7), 12 * 9),
            factors in proptest::collection::vec(1.0f32..6.0, 12 * 9),
            weighted in any::<bool>(),
            source in 0u32..108,
        ) {
            let shape = Shape { height: 12, width: 9 };
            let moves = all_moves(shape, &passable);
            let factors = if weighted { factors } else { vec![1.0; 108] };
            let field = one_to_all(shape, &moves, weighted.then_some(&factors[..]), source);
            for (found, expected) in field.distances.iter().zip(by_relaxation(shape, &moves, &factors, source)) {
                prop_assert!(*found == expected || (found - expected).abs() < 1e-9);
            }
        }

        #[test]
        fn a_path_is_as_long_as_its_distance(
            passable in proptest::collection::vec(proptest::bool::weighted(0.8), 12 * 9),
            source in 0u32..108,
            goal in 0u32..108,
        ) {
            let shape = Shape { height: 12, width: 9 };
            let moves = all_moves(shape, &passable);
            let field = one_to_all(shape, &moves, None, source);
            let path = field.path_to(goal);
            prop_assert_eq!(path.is_empty(), field.distances[goal as usize].is_infinite());
            let length: f64 = path.windows(2).map(|pair| {
                crate::shape::octile(shape.row_column(pair[0]), shape.row_column(pair[1]))
            }).sum();
            prop_assert!(path.is_empty() || (length - field.distances[goal as usize]).abs() < 1e-9);
        }
    }
}
