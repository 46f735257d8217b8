//! Distances from one cell to all others, and the paths that they stand for.

use std::sync::Arc;

use crate::octile;
use crate::shape::Shape;
use crate::weighted::step_length;

/// Length of the shortest path to each cell.
#[derive(Clone, Debug)]
pub enum Lengths {
    /// On a map where all cells cost the same: integers, see [`octile`].
    Octile(Vec<u32>),
    /// In cells times multiplier; infinite where there is no path.
    Weighted(Vec<f64>),
}

/// The shortest-path tree of one source.
#[derive(Clone, Debug)]
pub struct Field {
    /// Rows and columns.
    pub shape: Shape,
    /// The cell the distances are from.
    pub source: u32,
    /// Length of the shortest path to each cell.
    pub lengths: Lengths,
    /// Allowed steps of each cell when the field was grown.
    pub moves: Arc<Vec<u8>>,
    /// Multiplier of each cell, at least 1; none where all are 1.
    pub multiplier: Option<Arc<Vec<f32>>>,
}

/// Mean multiplier of two cells.
#[must_use]
pub fn mean_factor(factors: &[f32], from: usize, to: usize) -> f64 {
    0.5 * (f64::from(factors[from]) + f64::from(factors[to]))
}

/// Length of the step from one cell to another, in cells times multiplier.
#[must_use]
#[inline]
pub fn weighted_step(factors: Option<&[f32]>, from: usize, to: usize, step: usize) -> f64 {
    let factor = |cell: usize| factors.map_or(1.0, |factors| factors[cell]);
    step_length(step, factor(from), factor(to))
}

impl Field {
    /// Distance of a cell, in cells times multiplier; infinite if there is no path.
    #[must_use]
    pub fn distance(&self, cell: u32) -> f64 {
        match &self.lengths {
            Lengths::Weighted(lengths) => lengths[cell as usize],
            Lengths::Octile(lengths) => match lengths[cell as usize] {
                octile::FAR => f64::INFINITY,
                length if length < octile::AMBIGUOUS => {
                    octile::cells(length, octile::diagonals(length))
                }
                length => octile::cells(length, self.diagonals_to(cell)),
            },
        }
    }

    /// Distance of every cell, in cells times multiplier; infinite where there is no path.
    #[must_use]
    pub fn distances(&self) -> Vec<f64> {
        (0..self.shape.len() as u32)
            .map(|cell| self.distance(cell))
            .collect()
    }

    fn diagonals_to(&self, goal: u32) -> u32 {
        let path = self.path_to(goal);
        let diagonal = |pair: &&[u32]| {
            let (a, b) = (
                self.shape.row_column(pair[0]),
                self.shape.row_column(pair[1]),
            );
            a.0 != b.0 && a.1 != b.1
        };
        path.windows(2).filter(diagonal).count() as u32
    }

    /// The cells from the source to a goal, or nothing if there is no path.
    #[must_use]
    pub fn path_to(&self, goal: u32) -> Vec<u32> {
        let mut path = self.path_back(goal);
        path.reverse();
        path
    }

    /// The cells from a goal to the source, or nothing if there is no path.
    #[must_use]
    pub fn path_back(&self, goal: u32) -> Vec<u32> {
        let offsets = self.shape.offsets();
        let mut path = Vec::new();
        let mut next = self.has_path(goal).then_some(goal);
        while let Some(cell) = next {
            path.push(cell);
            let allowed = self.moves[cell as usize];
            // Steps are allowed in both directions or in none.
            next = (0..8)
                .filter(|step| allowed >> step & 1 == 1)
                .map(|step| ((cell as isize + offsets[step]) as u32, step))
                .find(|&(before, step)| self.is_step_of_tree(before, cell, step))
                .map(|(before, _)| before);
        }
        path
    }

    /// Whether there is a path to a cell.
    #[must_use]
    pub fn has_path(&self, cell: u32) -> bool {
        match &self.lengths {
            Lengths::Weighted(lengths) => lengths[cell as usize].is_finite(),
            Lengths::Octile(lengths) => lengths[cell as usize] != octile::FAR,
        }
    }

    /// Whether a shortest path may end with the step between two neighbours.
    fn is_step_of_tree(&self, from: u32, to: u32, step: usize) -> bool {
        let (from, to) = (from as usize, to as usize);
        match &self.lengths {
            Lengths::Weighted(lengths) => {
                let factors = self.multiplier.as_ref().map(|factors| &factors[..]);
                lengths[from] + weighted_step(factors, from, to, step) == lengths[to]
            }
            Lengths::Octile(lengths) => {
                lengths[from] != octile::FAR && lengths[from] + octile::STEPS[step] == lengths[to]
            }
        }
    }

    /// Memory the field holds, in bytes; allowed steps are shared with the map.
    #[must_use]
    pub fn nbytes(&self) -> usize {
        match &self.lengths {
            Lengths::Weighted(lengths) => lengths.len() * 8,
            Lengths::Octile(lengths) => lengths.len() * 4,
        }
    }
}
