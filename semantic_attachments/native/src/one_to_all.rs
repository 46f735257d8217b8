//! Distances from one cell to all others: Dijkstra's algorithm with buckets.
//!
//! Source: Denardo and Fox, "Shortest-route methods: 1. Reaching, pruning, and buckets", Operations
//! Research 27(1), 1979. No edge is shorter than one bucket is wide, so the cells of a bucket may be settled in any
//! order and the distances are exact; a queue operation costs a constant.
//! Complexity: `O(cells + longest distance)`.
//!
//! Where all cells cost the same, many shortest paths differ only in the order of their steps. Only those that take
//! diagonal steps first are followed, and others where an obstacle leaves no such path.
//! Source: Sturtevant and Rabin, "Canonical orderings on grids", IJCAI 2016, for grids without cut
//! corners as in Harabor and Grastien, "Improving jump point search", ICAPS 2014.

use crate::shape::{STEP_LENGTHS, STEPS, Shape};

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
        None => grow_canonically(shape, moves, source),
        Some(factors) => grow(shape, moves, source, factors),
    }
}

/// Mean multiplier of two cells.
#[must_use]
pub fn mean_factor(factors: &[f32], from: usize, to: usize) -> f64 {
    0.5 * (f64::from(factors[from]) + f64::from(factors[to]))
}

/// Cells to be settled, by distance; no edge may be shorter than 1, the width of a bucket.
struct Buckets {
    ring: Vec<Vec<u32>>,
    waiting: usize,
    number: u64,
    settling: Vec<u32>,
}

impl Buckets {
    fn new(longest_edge: f64) -> Self {
        Self {
            // A power of two, so that the slot is a matter of a mask.
            ring: vec![Vec::new(); (longest_edge.ceil() as usize + 2).next_power_of_two()],
            waiting: 0,
            number: 0,
            settling: Vec::new(),
        }
    }

    #[inline]
    fn push(&mut self, distance: f64, cell: u32) {
        let slot = distance as usize & (self.ring.len() - 1);
        self.ring[slot].push(cell);
        self.waiting += 1;
    }

    /// The cells of the next bucket, and its number; the vector is to be given back.
    fn next(&mut self) -> Option<(u64, Vec<u32>)> {
        if self.waiting == 0 {
            return None;
        }
        let number = self.number;
        let slot = number as usize & (self.ring.len() - 1);
        let cells = std::mem::replace(&mut self.ring[slot], std::mem::take(&mut self.settling));
        self.waiting -= cells.len();
        self.number += 1;
        Some((number, cells))
    }

    fn give_back(&mut self, mut cells: Vec<u32>) {
        cells.clear();
        self.settling = cells;
    }
}

fn unreached(shape: Shape, source: u32) -> Field {
    let mut distances = vec![f64::INFINITY; shape.len()];
    distances[source as usize] = 0.0;
    Field {
        shape,
        source,
        distances,
        steps: vec![NO_STEP; shape.len()],
    }
}

fn grow(shape: Shape, moves: &[u8], source: u32, factors: &[f32]) -> Field {
    let largest = f64::from(factors.iter().copied().fold(1.0, f32::max));
    let offsets = shape.offsets();
    let mut field = unreached(shape, source);
    let mut buckets = Buckets::new(largest * std::f64::consts::SQRT_2);
    buckets.push(0.0, source);
    while let Some((number, cells)) = buckets.next() {
        for &cell in &cells {
            let from = cell as usize;
            let distance = field.distances[from];
            if distance as u64 != number {
                continue; // a shorter path settled it in an earlier bucket
            }
            let mut open = moves[from];
            while open != 0 {
                let step = open.trailing_zeros() as usize;
                open &= open - 1;
                let to = (from as isize + offsets[step]) as usize;
                let known = field.distances[to];
                if known <= distance + STEP_LENGTHS[step] {
                    continue; // multipliers are at least 1
                }
                let reached = distance + STEP_LENGTHS[step] * mean_factor(factors, from, to);
                if reached < known {
                    field.distances[to] = reached;
                    field.steps[to] = step as u8;
                    buckets.push(reached, to as u32);
                }
            }
        }
        buckets.give_back(cells);
    }
    field
}

/// Paths of equal length may differ by rounding.
const TIE: f64 = 1e-9;

fn grow_canonically(shape: Shape, moves: &[u8], source: u32) -> Field {
    let offsets = shape.offsets();
    let successors = canonical_successors();
    let mut field = unreached(shape, source);
    // The steps that canonical paths may take on from a cell.
    let mut onward = vec![0u8; shape.len()];
    onward[source as usize] = u8::MAX;
    let mut buckets = Buckets::new(std::f64::consts::SQRT_2);
    buckets.push(0.0, source);
    while let Some((number, cells)) = buckets.next() {
        for &cell in &cells {
            let from = cell as usize;
            let distance = field.distances[from];
            if distance as u64 != number {
                continue; // a shorter path settled it in an earlier bucket
            }
            let all = moves[from];
            let mut open = all & std::mem::take(&mut onward[from]);
            while open != 0 {
                let step = open.trailing_zeros() as usize;
                open &= open - 1;
                let to = (from as isize + offsets[step]) as usize;
                let reached = distance + STEP_LENGTHS[step];
                let known = field.distances[to];
                if reached < known - TIE {
                    field.distances[to] = reached;
                    field.steps[to] = step as u8;
                    onward[to] = successors[step][all as usize];
                    buckets.push(reached, to as u32);
                } else if reached < known + TIE {
                    // Two canonical paths meet: both go on.
                    onward[to] |= successors[step][all as usize];
                }
            }
        }
        buckets.give_back(cells);
    }
    field
}

/// Steps that continue a canonical path, by its last step and the moves of the cell that it took it from.
///
/// After a diagonal step: the same step and its two components. After a straight step: the same step; on
/// a side where the cell before is an obstacle no diagonal came by, so the turn to that side, straight or
/// diagonally, continues it as well.
fn canonical_successors() -> [[u8; 256]; 8] {
    let bit = |rows: i64, columns: i64| {
        1u8 << STEPS
            .iter()
            .position(|&step| step == (rows, columns))
            .unwrap_or(0)
    };
    let mut table = [[0; 256]; 8];
    for (step, &(rows, columns)) in STEPS.iter().enumerate() {
        for (moves, entry) in table[step].iter_mut().enumerate() {
            *entry = 1 << step;
            if rows != 0 && columns != 0 {
                *entry |= bit(rows, 0) | bit(0, columns);
                continue;
            }
            for side in [(columns, rows), (-columns, -rows)] {
                if moves as u8 & bit(side.0, side.1) == 0 {
                    *entry |= bit(side.0, side.1) | bit(rows + side.0, columns + side.1);
                }
            }
        }
    }
    table
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
        #![proptest_config(ProptestConfig::with_cases(1500))]

        #[test]
        fn equals_relaxation_on_random_grids(
            passable in proptest::collection::vec(proptest::bool::weighted(0.75), 12 * 9),
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
