//! Where a robot of one class can be: static obstacles and blockades inflated by its radius.
//!
//! Blockades are kept apart from the static map as stamps (the cells each covers once inflated), so opening the one a
//! robot starts from or goes to changes only the cells around it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use crate::field::Field;
use crate::inflation::{inflate, inflate_cells};
use crate::length::CellMap;
use crate::moves::{all_moves, moves_of};
use crate::one_to_all::one_to_all;
use crate::shape::{STEP_LENGTHS, Shape};

/// The known map as one class of robots sees it.
#[derive(Clone, Debug)]
pub struct Traversability {
    /// Rows and columns.
    pub shape: Shape,
    /// Radius of the robot, in cells.
    pub radius_cells: f64,
    /// Length multiplier of each cell (at least 1), or 1 everywhere.
    pub multiplier: Option<Arc<Vec<f32>>>,
    /// Cells that are solid: static obstacles, before inflation.
    solid: Vec<bool>,
    /// Cells a robot's centre may be in if there were no blockades.
    open: Vec<bool>,
    /// Blockades: their own cells and their inflated cells, sorted.
    blockades: Vec<(Vec<u32>, Vec<u32>)>,
    /// Number of stamps that cover a cell.
    stamps: Vec<u16>,
    /// Allowed steps with every blockade closed.
    moves: Arc<Vec<u8>>,
}

impl Traversability {
    /// Inflates `solid` and the blockades' cells by the radius; `forbidden` cells are not inflated.
    ///
    /// The slices have one entry a cell; blockade cells must lie in the grid.
    #[must_use]
    pub fn new(
        shape: Shape,
        solid: Vec<bool>,
        forbidden: &[bool],
        radius_cells: f64,
        multiplier: Option<Vec<f32>>,
        blockades: Vec<Vec<u32>>,
    ) -> Self {
        let mut open = inflate(shape, &solid, radius_cells);
        for (cell, &out) in open.iter_mut().zip(forbidden) {
            *cell = !*cell && !out;
        }
        let blockades: Vec<_> = blockades
            .into_iter()
            .map(|mut cells| {
                cells.sort_unstable();
                cells.dedup();
                let stamp = inflate_cells(shape, &cells, radius_cells);
                (cells, stamp)
            })
            .collect();
        let mut stamps = vec![0u16; shape.len()];
        for &cell in blockades.iter().flat_map(|(_, stamp)| stamp) {
            stamps[cell as usize] += 1;
        }
        let passable: Vec<bool> = open
            .iter()
            .zip(&stamps)
            .map(|(&open, &count)| open && count == 0)
            .collect();
        let moves = Arc::new(all_moves(shape, &passable));
        Self {
            shape,
            radius_cells,
            multiplier: multiplier.map(Arc::new),
            solid,
            open,
            blockades,
            stamps,
            moves,
        }
    }

    /// Number of blockades.
    #[must_use]
    pub fn blockade_count(&self) -> usize {
        self.blockades.len()
    }

    /// The cells a blockade covers once inflated, sorted.
    #[must_use]
    pub fn stamp(&self, blockade: usize) -> &[u32] {
        &self.blockades[blockade].1
    }

    /// Cells a robot's centre may be in if there were no blockades.
    #[must_use]
    pub fn open(&self) -> &[bool] {
        &self.open
    }

    /// Whether a robot's centre may be in the cell when the given blockades are opened.
    #[must_use]
    pub fn passable(&self, cell: u32, opened: &[usize]) -> bool {
        if !self.open[cell as usize] {
            return false;
        }
        let closed = self.stamps[cell as usize] as usize;
        closed == 0
            || closed
                == opened
                    .iter()
                    .filter(|&&b| self.blockades[b].1.binary_search(&cell).is_ok())
                    .count()
    }

    /// Where a robot's centre may be when the given blockades are opened.
    #[must_use]
    pub fn all_passable(&self, opened: &[usize]) -> Vec<bool> {
        let mut passable: Vec<bool> = self
            .open
            .iter()
            .zip(&self.stamps)
            .map(|(&open, &count)| open && count == 0)
            .collect();
        for &cell in opened
            .iter()
            .flat_map(|&blockade| &self.blockades[blockade].1)
        {
            passable[cell as usize] = self.passable(cell, opened);
        }
        passable
    }

    /// Allowed steps of every cell when the given blockades are opened.
    #[must_use]
    pub fn moves(&self, opened: &[usize]) -> Arc<Vec<u8>> {
        if opened.is_empty() {
            return Arc::clone(&self.moves);
        }
        let mut moves = self.moves.to_vec();
        for (cell, bits) in self.changed_moves(opened) {
            moves[cell as usize] = bits;
        }
        Arc::new(moves)
    }

    /// Allowed steps of the cells in and next to the opened blockades.
    #[must_use]
    pub fn changed_moves(&self, opened: &[usize]) -> CellMap<u8> {
        let mut changed = CellMap::default();
        for &cell in opened
            .iter()
            .flat_map(|&blockade| &self.blockades[blockade].1)
        {
            let around = (0..8).filter_map(|step| self.shape.neighbour(cell, step));
            for near in around.chain([cell]) {
                changed.entry(near).or_insert_with(|| {
                    moves_of(self.shape, near, |other| self.passable(other, opened))
                });
            }
        }
        changed
    }

    /// Distances from one cell to all others when the given blockades are opened.
    #[must_use]
    pub fn field(&self, source: u32, opened: &[usize]) -> Field {
        one_to_all(
            self.shape,
            self.moves(opened),
            self.multiplier.clone(),
            source,
        )
    }

    /// Whether the cell is solid: an obstacle, or part of a blockade that is not opened.
    fn is_solid(&self, cell: u32, opened: &[usize]) -> bool {
        self.solid[cell as usize]
            || (self.stamps[cell as usize] > 0
                && self
                    .blockades
                    .iter()
                    .enumerate()
                    .any(|(index, (cells, _))| {
                        !opened.contains(&index) && cells.binary_search(&cell).is_ok()
                    }))
    }

    /// The nearest cell a robot's centre may be in, and its distance in cells, at most `limit_cells` away.
    ///
    /// A robot that stands nearer to a wall than its radius leaves through cells that are not solid, so it never
    /// comes out on the other side of the wall.
    #[must_use]
    pub fn nearest_passable(
        &self,
        start: u32,
        opened: &[usize],
        limit_cells: f64,
    ) -> Option<(u32, f64)> {
        if self.passable(start, opened) {
            return Some((start, 0.0));
        }
        let mut distances = CellMap::from_iter([(start, 0.0)]);
        let mut queue = BinaryHeap::from([Reverse((0.0_f64.to_bits(), start))]);
        while let Some(Reverse((bits, cell))) = queue.pop() {
            let distance = f64::from_bits(bits);
            if distance > distances[&cell] {
                continue;
            }
            if self.passable(cell, opened) {
                return Some((cell, distance));
            }
            for (step, length) in STEP_LENGTHS.iter().enumerate() {
                let Some(next) = self.shape.neighbour(cell, step) else {
                    continue;
                };
                let reached = distance + length;
                let known = distances.get(&next).copied().unwrap_or(f64::INFINITY);
                if reached < known && reached <= limit_cells && !self.is_solid(next, opened) {
                    distances.insert(next, reached);
                    queue.push(Reverse((reached.to_bits(), next)));
                }
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SHAPE: Shape = Shape {
        height: 9,
        width: 15,
    };

    /// A corridor of three rows between walls, closed by one blockade in column 7.
    fn corridor(radius: f64) -> Traversability {
        let solid = (0..SHAPE.len())
            .map(|cell| !(3..6).contains(&(cell / SHAPE.width)))
            .collect();
        let blockade = (3..6).map(|row| SHAPE.cell(row, 7).unwrap()).collect();
        Traversability::new(SHAPE, solid, &[false; 9 * 15], radius, None, vec![blockade])
    }

    #[test]
    fn a_corridor_as_wide_as_the_robot_lets_it_through() {
        assert!(corridor(1.5).passable(SHAPE.cell(4, 2).unwrap(), &[]));
        assert!(!corridor(1.6).passable(SHAPE.cell(4, 2).unwrap(), &[]));
    }

    #[test]
    fn a_robot_inside_the_inflation_leaves_on_its_own_side() {
        let map = corridor(1.5);
        let beside = SHAPE.cell(4, 6).unwrap();
        assert!(!map.passable(beside, &[]));
        assert_eq!(
            map.nearest_passable(beside, &[], 3.0),
            Some((SHAPE.cell(4, 5).unwrap(), 1.0))
        );
        assert_eq!(map.nearest_passable(beside, &[0], 3.0), Some((beside, 0.0)));
        assert_eq!(map.nearest_passable(beside, &[], 0.5), None);
        assert_eq!(
            map.nearest_passable(SHAPE.cell(0, 6).unwrap(), &[], 9.0),
            None
        );
    }

    proptest! {
        #[test]
        fn opening_blockades_equals_a_map_without_them(
            solid in proptest::collection::vec(proptest::bool::weighted(0.05), 9 * 15),
            first in proptest::collection::vec(0u32..135, 1..6),
            second in proptest::collection::vec(0u32..135, 1..6),
            radius in 0.0..2.5,
        ) {
            let none = [false; 135];
            let blockades = vec![first.clone(), second];
            let map = Traversability::new(SHAPE, solid.clone(), &none, radius, None, blockades);
            let without_second = Traversability::new(SHAPE, solid.clone(), &none, radius, None, vec![first]);
            let empty = Traversability::new(SHAPE, solid, &none, radius, None, vec![]);
            prop_assert_eq!(map.moves(&[1]), without_second.moves(&[]));
            prop_assert_eq!(map.moves(&[0, 1]), empty.moves(&[]));
        }
    }
}
