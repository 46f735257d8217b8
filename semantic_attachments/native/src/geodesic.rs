//! Lengths of shortest paths inside a region from the nearest of several sources.
//!
//! Dial's buckets over chamfer steps of 12 and 17 (a diagonal of 1.4167 cells): linear in the cells
//! and without a heap, for the many fields that a coordination of robots asks for at once.

use crate::moves::all_moves;
use crate::shape::Shape;

/// Length of a straight step; a diagonal one is [`DIAGONAL`].
const STRAIGHT: u32 = 12;
const DIAGONAL: u32 = 17;
/// What stands for "no path" in [`Geodesic::lengths`].
const FAR: u32 = u32::MAX;

fn step_length(step: usize) -> u32 {
    if step < 4 { STRAIGHT } else { DIAGONAL }
}

/// A region with the steps that its cells allow: none off the grid, none across a corner.
pub struct Region {
    shape: Shape,
    moves: Vec<u8>,
}

/// Lengths of the shortest paths from the nearest source.
pub struct Geodesic {
    /// In twelfths of a cell.
    lengths: Vec<u32>,
    /// Index of the nearest source of several; empty if there is one only.
    source: Vec<u32>,
}

impl Region {
    /// The steps of every cell for which `inside` is true.
    #[must_use]
    pub fn new(shape: Shape, inside: &[bool]) -> Self {
        Self {
            shape,
            moves: all_moves(shape, inside),
        }
    }

    /// The region's rows and columns.
    #[must_use]
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Path lengths from the nearest source; stops once all `goals` are reached, if there are any.
    ///
    /// A source outside the region reaches only itself.
    #[must_use]
    pub fn geodesic(&self, sources: &[u32], goals: &[u32]) -> Geodesic {
        let cells = self.shape.len();
        let several = sources.len() > 1;
        let mut found = Geodesic {
            lengths: vec![FAR; cells],
            source: vec![Geodesic::NO_SOURCE; if several { cells } else { 0 }],
        };
        let mut is_goal = vec![false; if goals.is_empty() { 0 } else { cells }];
        let mut missing = 0;
        for &goal in goals {
            if !std::mem::replace(&mut is_goal[goal as usize], true) {
                missing += 1;
            }
        }
        let mut buckets: Vec<Vec<u32>> = vec![Vec::new(); DIAGONAL as usize + 1];
        for (index, &source) in sources.iter().enumerate() {
            if found.lengths[source as usize] == FAR {
                found.lengths[source as usize] = 0;
                if several {
                    found.source[source as usize] = index as u32;
                }
                buckets[0].push(source);
            }
        }
        let offsets = self.shape.offsets();
        let (mut length, mut empty) = (0u32, 0);
        while empty <= DIAGONAL {
            let slot = (length % (DIAGONAL + 1)) as usize;
            let bucket = std::mem::take(&mut buckets[slot]);
            empty = if bucket.is_empty() { empty + 1 } else { 0 };
            for &cell in &bucket {
                let at = cell as usize;
                if found.lengths[at] != length {
                    continue;
                }
                if !is_goal.is_empty() && std::mem::replace(&mut is_goal[at], false) {
                    missing -= 1;
                    if missing == 0 {
                        found.forget_beyond(length);
                        return found;
                    }
                }
                let mut moves = self.moves[at];
                while moves != 0 {
                    let step = moves.trailing_zeros() as usize;
                    moves &= moves - 1;
                    let next = at.wrapping_add_signed(offsets[step]);
                    let longer = length + step_length(step);
                    if longer < found.lengths[next] {
                        found.lengths[next] = longer;
                        if several {
                            found.source[next] = found.source[at];
                        }
                        buckets[(longer % (DIAGONAL + 1)) as usize].push(next as u32);
                    }
                }
            }
            length += 1;
        }
        found
    }

    /// The cells of a shortest path from `start` to the source it was reached from; empty if none.
    #[must_use]
    pub fn descend(&self, field: &Geodesic, start: u32) -> Vec<u32> {
        if field.lengths[start as usize] == FAR {
            return Vec::new();
        }
        let (offsets, mut path, mut at) = (self.shape.offsets(), vec![start], start as usize);
        while field.lengths[at] > 0 {
            let lower = (0..8usize)
                .filter(|step| (self.moves[at] >> step) & 1 == 1)
                .map(|step| (step, at.wrapping_add_signed(offsets[step])))
                .find(|&(step, next)| {
                    let length = field.lengths[next];
                    length != FAR && length + step_length(step) == field.lengths[at]
                });
            let Some((_, next)) = lower else {
                return Vec::new();
            };
            path.push(next as u32);
            at = next;
        }
        path
    }
}

impl Geodesic {
    /// What stands for "no path" in [`Geodesic::sources`].
    pub const NO_SOURCE: u32 = u32::MAX;

    /// Length to a cell [cells], infinite without a path.
    #[must_use]
    pub fn length_cells(&self, cell: usize) -> f32 {
        match self.lengths[cell] {
            FAR => f32::INFINITY,
            length => length as f32 / STRAIGHT as f32,
        }
    }

    /// Index of each cell's nearest source, or [`Geodesic::NO_SOURCE`]; row-major.
    #[must_use]
    pub fn sources(&self) -> Vec<u32> {
        let nearest = |cell: usize| match self.lengths[cell] {
            FAR => Self::NO_SOURCE,
            _ => self.source.get(cell).copied().unwrap_or(0),
        };
        (0..self.lengths.len()).map(nearest).collect()
    }

    /// All lengths [cells], row-major.
    #[must_use]
    pub fn lengths_cells(&self) -> Vec<f32> {
        (0..self.lengths.len())
            .map(|cell| self.length_cells(cell))
            .collect()
    }

    /// A search that stopped early knows only upper bounds beyond.
    fn forget_beyond(&mut self, length: u32) {
        for known in &mut self.lengths {
            if *known > length {
                *known = FAR;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::one_to_all::one_to_all;
    use proptest::prelude::*;
    use std::sync::Arc;

    proptest! {
        #[test]
        fn lengths_are_those_of_dijkstra_but_for_the_diagonal(
            width in 2usize..16, height in 2usize..16,
            bits in proptest::collection::vec(0u8..4, 256), source in 0u32..256,
        ) {
            let shape = Shape { height, width };
            let source = source % shape.len() as u32;
            let mut inside: Vec<bool> = bits[..shape.len()].iter().map(|&bit| bit != 0).collect();
            inside[source as usize] = true;
            let exact = one_to_all(shape, Arc::new(all_moves(shape, &inside)), None, source);
            let region = Region::new(shape, &inside);
            let found = region.geodesic(&[source], &[]);
            for (cell, &distance) in exact.distances().iter().enumerate() {
                let length = f64::from(found.length_cells(cell));
                prop_assert_eq!(length.is_finite(), distance.is_finite());
                if distance.is_finite() {
                    prop_assert!((length - distance).abs() <= 0.002 * distance + 1e-4);
                    let path = region.descend(&found, cell as u32);
                    prop_assert_eq!((path[0], path[path.len() - 1]), (cell as u32, source));
                }
            }
            let goal = (shape.len() / 2) as u32;
            let early = region.geodesic(&[source], &[goal]);
            prop_assert_eq!(
                early.length_cells(goal as usize), found.length_cells(goal as usize));
        }
    }

    #[test]
    fn each_cell_belongs_to_its_nearest_source() {
        let shape = Shape {
            height: 1,
            width: 7,
        };
        let region = Region::new(shape, &[true, true, true, true, true, false, true]);
        let found = region.geodesic(&[4, 0], &[]);
        let (sources, none) = (found.sources(), Geodesic::NO_SOURCE);
        assert_eq!(sources, [1, 1, sources[2], 0, 0, none, none]);
        assert_eq!(found.length_cells(2), 2.0);
    }
}
