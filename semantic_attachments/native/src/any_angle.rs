//! Any-angle distances from one cell to all others: straight lines between cells that see each other.
//!
//! Source: Nash, Koenig and Tovey, "Lazy Theta*: Any-angle path planning and path length analysis in
//! 3D", AAAI 2010, without a goal. Paths are near the shortest, not always the shortest, and hardly ever longer than those that
//! use the eight steps only. Lines run over cells of one multiplier. Complexity: `O(cells * (log + line of sight))`.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::field::mean_factor;
use crate::line_of_sight::{sees, touched};
use crate::shape::{STEP_LENGTHS, Shape};

/// The tree of straight lines from one source.
#[derive(Clone, Debug)]
pub struct AnyAngleField {
    /// Rows and columns.
    pub shape: Shape,
    /// Distance of each cell, in cells times multiplier; infinite where there is no path.
    pub distances: Vec<f64>,
    /// The cell at the other end of the line that leads to each cell; itself for the source.
    pub parents: Vec<u32>,
}

impl AnyAngleField {
    /// All cells touched by the lines from the source to a goal, or nothing if there is no path.
    #[must_use]
    pub fn path_to(&self, goal: u32) -> Vec<u32> {
        if self.distances[goal as usize].is_infinite() {
            return Vec::new();
        }
        let mut path = Vec::new();
        let mut cell = goal;
        while self.parents[cell as usize] != cell {
            let mut line = touched(self.shape, cell, self.parents[cell as usize]);
            line.pop();
            path.extend(line);
            cell = self.parents[cell as usize];
        }
        path.push(cell);
        path.reverse();
        path
    }
}

/// Grows the tree of `source` over the allowed `moves`; `passable` says where lines may run.
#[must_use]
pub fn any_angle(
    shape: Shape,
    moves: &[u8],
    passable: &[bool],
    multiplier: Option<&[f32]>,
    source: u32,
) -> AnyAngleField {
    let factor = |cell: u32| multiplier.map_or(1.0, |factors| f64::from(factors[cell as usize]));
    let line = |from: u32, to: u32| {
        let ((r0, c0), (r1, c1)) = (shape.row_column(from), shape.row_column(to));
        ((r1 - r0) as f64).hypot((c1 - c0) as f64) * factor(from)
    };
    let edge = |from: u32, to: u32, step: usize| {
        STEP_LENGTHS[step]
            * multiplier.map_or(1.0, |factors| {
                mean_factor(factors, from as usize, to as usize)
            })
    };
    let mut distances = vec![f64::INFINITY; shape.len()];
    let mut parents: Vec<u32> = (0..shape.len() as u32).collect();
    let mut settled = vec![false; shape.len()];
    distances[source as usize] = 0.0;
    let mut queue = BinaryHeap::from([Reverse((0.0_f64.to_bits(), source))]);
    while let Some(Reverse((bits, cell))) = queue.pop() {
        let here = cell as usize;
        if settled[here] || f64::from_bits(bits) > distances[here] {
            continue;
        }
        let parent = parents[here];
        let uniform = |other: u32| {
            passable[other as usize] && (multiplier.is_none() || factor(other) == factor(parent))
        };
        if parent != cell && !sees(shape, parent, cell, uniform) {
            // The line was a guess: step from the best settled neighbour instead. Moves are symmetric.
            let mut best = (f64::INFINITY, parent);
            for (step, _) in STEP_LENGTHS.iter().enumerate() {
                if moves[here] >> step & 1 == 0 {
                    continue;
                }
                let Some(near) = shape.neighbour(cell, step) else {
                    continue;
                };
                let reached = distances[near as usize] + edge(near, cell, step);
                if settled[near as usize] && reached < best.0 {
                    best = (reached, near);
                }
            }
            (distances[here], parents[here]) = best;
        }
        settled[here] = true;
        let (parent, distance) = (parents[here], distances[here]);
        for (step, _) in STEP_LENGTHS.iter().enumerate() {
            if moves[here] >> step & 1 == 0 {
                continue;
            }
            let Some(next) = shape.neighbour(cell, step) else {
                continue;
            };
            let to = next as usize;
            if settled[to] {
                continue;
            }
            let straight = factor(next) == factor(parent) && factor(cell) == factor(parent);
            let guess = if straight {
                (distances[parent as usize] + line(parent, next), parent)
            } else {
                (distance + edge(cell, next, step), cell)
            };
            if guess.0 < distances[to] {
                (distances[to], parents[to]) = guess;
                queue.push(Reverse((guess.0.to_bits(), next)));
            }
        }
    }
    AnyAngleField {
        shape,
        distances,
        parents,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::moves::all_moves;
    use crate::one_to_all::one_to_all;
    use proptest::prelude::*;
    use std::sync::Arc;

    #[test]
    fn an_empty_grid_has_euclidean_distances() {
        let shape = Shape {
            height: 20,
            width: 30,
        };
        let passable = vec![true; shape.len()];
        let source = shape.cell(7, 11).unwrap();
        let field = any_angle(shape, &all_moves(shape, &passable), &passable, None, source);
        for cell in 0..shape.len() as u32 {
            let (row, column) = shape.row_column(cell);
            let expected = ((row - 7) as f64).hypot((column - 11) as f64);
            assert!((field.distances[cell as usize] - expected).abs() < 1e-9);
        }
    }

    proptest! {
        #[test]
        fn lines_are_free_and_hardly_longer_than_grid_paths(
            passable in proptest::collection::vec(proptest::bool::weighted(0.8), 12 * 14),
            coarse in proptest::collection::vec(1u8..3, 12 * 14),
            weighted in any::<bool>(),
            source in 0u32..168,
        ) {
            let shape = Shape { height: 12, width: 14 };
            let moves = all_moves(shape, &passable);
            let factors: Vec<f32> = coarse.iter().map(|&factor| f32::from(factor)).collect();
            let factors = weighted.then_some(factors);
            let field = any_angle(shape, &moves, &passable, factors.as_deref(), source);
            let grid = one_to_all(shape, Arc::new(moves), factors.map(Arc::new), source);
            for cell in 0..168u32 {
                let (found, octile) = (field.distances[cell as usize], grid.distance(cell));
                prop_assert_eq!(found.is_finite(), octile.is_finite());
                if found.is_finite() {
                    prop_assert!(found <= octile * 1.02 + 1e-9);
                    prop_assert!(weighted || found >= octile / 1.0824);
                    let path = field.path_to(cell);
                    prop_assert_eq!((path[0], path[path.len() - 1]), (source, cell));
                    prop_assert!(path.len() == 1 || path.iter().all(|&c| passable[c as usize]));
                }
            }
        }
    }
}
