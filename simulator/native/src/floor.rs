//! A floor plan: a grid of walls with each cell's clearance, in the map frame.

use std::fmt;
use std::sync::Arc;

use crate::clearance::distances_to_squares;

/// A position in the map frame [m].
pub type Point = [f64; 2];
/// Both ends of a straight obstacle in the map frame [m].
pub type Segment = [Point; 2];

/// How far a leg's clearance may fall short of what `leg_is_clear` was asked for [m].
pub const LEG_TOLERANCE_M: f64 = 0.01;
/// Distance that a body's centre keeps from forbidden terrain on a leg [m].
const TERRAIN_GAP_M: f64 = 0.005;

/// Walls on a grid; row 0 is the bottom one, whatever lies outside is wall.
pub struct Floor {
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Edge length of a cell [m].
    pub resolution_m: f64,
    /// Lower left corner of cell (0, 0).
    pub origin_m: Point,
    occupied: Arc<[bool]>,
    clearance_m: Arc<[f32]>,
    /// Forbidden terrain, its cells as the walls of a floor of their own.
    terrain: Option<Box<Floor>>,
}

/// Cells that do not make a grid.
#[derive(Debug, PartialEq)]
pub struct FloorError(String);

impl fmt::Display for FloorError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl Floor {
    /// Takes `width * height` cells, row-major, `true` where there is a wall.
    pub fn new(
        occupied: Vec<bool>,
        width: usize,
        height: usize,
        resolution_m: f64,
        origin_m: Point,
    ) -> Result<Self, FloorError> {
        if occupied.len() != width * height || occupied.is_empty() {
            return Err(FloorError(format!(
                "{} cells do not make a grid of {width} x {height}",
                occupied.len()
            )));
        }
        if !(resolution_m > 0.0 && resolution_m.is_finite()) {
            return Err(FloorError(format!(
                "resolution must be positive, not {resolution_m}"
            )));
        }
        let clearance_m = distances_to_squares(&occupied, width, height)
            .into_iter()
            .map(|cells| (f64::from(cells) * resolution_m) as f32)
            .collect();
        Ok(Self {
            width,
            height,
            resolution_m,
            origin_m,
            occupied: occupied.into(),
            clearance_m,
            terrain: None,
        })
    }

    /// The same walls with forbidden terrain, `true` where a body's centre may not be; its edge may
    /// hang over.
    pub fn forbidding(&self, forbidden: Vec<bool>) -> Result<Self, FloorError> {
        let terrain = if forbidden.contains(&true) {
            let (width, height) = (self.width, self.height);
            let floor = Self::new(forbidden, width, height, self.resolution_m, self.origin_m)?;
            Some(Box::new(floor))
        } else {
            None
        };
        Ok(Self {
            occupied: Arc::clone(&self.occupied),
            clearance_m: Arc::clone(&self.clearance_m),
            terrain,
            ..*self
        })
    }

    /// Column and row of a position, or None outside.
    pub fn cell(&self, [x, y]: Point) -> Option<(usize, usize)> {
        let column = (x - self.origin_m[0]) / self.resolution_m;
        let row = (y - self.origin_m[1]) / self.resolution_m;
        let inside =
            column >= 0.0 && row >= 0.0 && column < self.width as f64 && row < self.height as f64;
        inside.then_some((column as usize, row as usize))
    }

    /// Centre of a cell.
    pub fn centre(&self, column: usize, row: usize) -> Point {
        [
            self.origin_m[0] + (column as f64 + 0.5) * self.resolution_m,
            self.origin_m[1] + (row as f64 + 0.5) * self.resolution_m,
        ]
    }

    /// Whether a cell is wall.
    pub fn is_occupied(&self, column: usize, row: usize) -> bool {
        self.occupied[row * self.width + column]
    }

    /// Whether a position lies in terrain that a body's centre may not enter.
    pub fn is_forbidden(&self, position: Point) -> bool {
        self.terrain.as_ref().is_some_and(|terrain| {
            terrain
                .cell(position)
                .is_none_or(|(column, row)| terrain.is_occupied(column, row))
        })
    }

    /// Whether a position lies in a wall or outside the grid.
    fn is_wall(&self, position: Point) -> bool {
        self.cell(position)
            .is_none_or(|(column, row)| self.is_occupied(column, row))
    }

    /// Distance from a cell's centre to the nearest forbidden terrain, zero within [m].
    pub fn terrain_clearance_at_centre(&self, column: usize, row: usize) -> f64 {
        self.terrain.as_ref().map_or(f64::INFINITY, |terrain| {
            terrain.clearance_at_centre(column, row)
        })
    }

    /// Distance from a cell's centre to the nearest wall [m].
    pub fn clearance_at_centre(&self, column: usize, row: usize) -> f64 {
        f64::from(self.clearance_m[row * self.width + column])
    }

    /// All cells' clearances, row-major [m].
    pub fn clearance_m(&self) -> &[f32] {
        &self.clearance_m
    }

    /// A distance that certainly is free around a position: quick, and at most a cell too small.
    pub fn certain_clearance(&self, position: Point) -> f64 {
        let Some((column, row)) = self.cell(position) else {
            return 0.0;
        };
        let to_centre = distance(position, self.centre(column, row));
        (self.clearance_at_centre(column, row) - to_centre).max(0.0)
    }

    /// Exact distance from a position to the nearest wall, or `limit_m` where that is less.
    pub fn clearance(&self, position: Point, limit_m: f64) -> f64 {
        let Some((column, row)) = self.cell(position) else {
            return 0.0;
        };
        let to_centre = distance(position, self.centre(column, row));
        let at_centre = self.clearance_at_centre(column, row);
        if at_centre - to_centre >= limit_m {
            return limit_m;
        }
        let mut nearest = limit_m.min(at_centre + to_centre);
        let local = [
            position[0] - self.origin_m[0],
            position[1] - self.origin_m[1],
        ];
        let (size_x, size_y) = (
            self.width as f64 * self.resolution_m,
            self.height as f64 * self.resolution_m,
        );
        nearest = nearest
            .min(local[0])
            .min(local[1])
            .min(size_x - local[0])
            .min(size_y - local[1]);
        let low = |x: f64| (((x - nearest) / self.resolution_m).floor().max(0.0)) as usize;
        let high = |x: f64, count: usize| {
            (((x + nearest) / self.resolution_m).floor().max(0.0) as usize).min(count - 1)
        };
        let columns = low(local[0])..=high(local[0], self.width);
        for row in low(local[1])..=high(local[1], self.height) {
            let dy = gap(local[1], row, self.resolution_m);
            for column in columns.clone() {
                if self.occupied[row * self.width + column] {
                    nearest = nearest.min(gap(local[0], column, self.resolution_m).hypot(dy));
                }
            }
        }
        nearest
    }

    /// Whether a disc may move along a straight leg: its edge touches no wall, its centre enters no
    /// forbidden terrain.
    pub fn leg_is_clear(&self, from: Point, to: Point, radius_m: f64) -> bool {
        self.disc_passes(from, to, radius_m) && self.centre_passes(from, to)
    }

    /// Whether a body's centre may move along a straight leg without entering forbidden terrain.
    pub fn centre_passes(&self, from: Point, to: Point) -> bool {
        self.terrain.as_ref().is_none_or(|terrain| {
            // Whoever stands nearer to it already, even at its very edge, may leave.
            terrain.disc_passes(from, to, terrain.clearance(from, TERRAIN_GAP_M))
        })
    }

    /// Whether a disc may move along a straight leg without touching a wall. A disc without a radius
    /// is a line of sight: it ends in a wall as well.
    pub fn disc_passes(&self, from: Point, to: Point, radius_m: f64) -> bool {
        let length = distance(from, to);
        let mut travelled = 0.0;
        loop {
            let ratio = if length > 0.0 {
                travelled / length
            } else {
                0.0
            };
            let at = [
                from[0] + ratio * (to[0] - from[0]),
                from[1] + ratio * (to[1] - from[1]),
            ];
            let mut free = self.certain_clearance(at) - radius_m;
            if free < self.resolution_m {
                free = self.clearance(at, radius_m + self.resolution_m) - radius_m;
                if free < -1e-9 || self.is_wall(at) {
                    return false;
                }
            }
            if travelled >= length {
                return true;
            }
            travelled = (travelled + free + LEG_TOLERANCE_M).min(length);
        }
    }
}

/// Gap between a coordinate and the interval that a cell covers [m].
fn gap(coordinate: f64, cell: usize, resolution_m: f64) -> f64 {
    let low = cell as f64 * resolution_m;
    (low - coordinate)
        .max(coordinate - low - resolution_m)
        .max(0.0)
}

/// Euclidean distance [m].
pub fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The point of a segment that is nearest to a position.
pub fn nearest_on_segment(position: Point, [a, b]: Segment) -> Point {
    let along = [b[0] - a[0], b[1] - a[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let ratio = if squared > 0.0 {
        (((position[0] - a[0]) * along[0] + (position[1] - a[1]) * along[1]) / squared)
            .clamp(0.0, 1.0)
    } else {
        0.0
    };
    [a[0] + ratio * along[0], a[1] + ratio * along[1]]
}

/// Distance between two segments, zero where they cross [m].
pub fn segment_distance(first: Segment, second: Segment) -> f64 {
    let side =
        |[a, b]: Segment, p: Point| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let straddles = |of: Segment, ends: Segment| side(of, ends[0]) * side(of, ends[1]) < 0.0;
    if straddles(first, second) && straddles(second, first) {
        return 0.0;
    }
    let to = |p: Point, segment: Segment| distance(p, nearest_on_segment(p, segment));
    to(first[0], second)
        .min(to(first[1], second))
        .min(to(second[0], first))
        .min(to(second[1], first))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A floor from a drawing, top row first, `#` is wall.
    pub(crate) fn drawn(rows: &[&str], resolution_m: f64) -> Floor {
        let (width, height) = (rows[0].len(), rows.len());
        let occupied = rows.iter().rev().flat_map(|r| r.bytes()).map(|c| c == b'#');
        Floor::new(occupied.collect(), width, height, resolution_m, [0.0, 0.0]).unwrap()
    }

    #[test]
    fn cells_that_make_no_grid_are_refused() {
        assert!(Floor::new(vec![false; 5], 2, 3, 0.1, [0.0, 0.0]).is_err());
        assert!(Floor::new(vec![false; 6], 2, 3, 0.0, [0.0, 0.0]).is_err());
    }

    #[test]
    fn a_disc_passes_a_door_that_is_wide_enough() {
        let floor = drawn(&[".....", ".....", "#...#", ".....", "....."], 0.2);
        let (below, above) = ([0.5, 0.25], [0.5, 0.75]);
        assert!(floor.leg_is_clear(below, above, 0.24));
        assert!(floor.leg_is_clear(below, above, 0.25));
        assert!(!floor.leg_is_clear(below, above, 0.31));
    }

    #[test]
    fn a_line_of_sight_ends_at_a_wall() {
        let floor = drawn(&[".....", "..#..", "..#..", "..#..", "....."], 0.2);
        assert!(!floor.disc_passes([0.1, 0.5], [0.9, 0.5], 0.0));
        assert!(!floor.disc_passes([0.1, 0.5], [0.5, 0.5], 0.0));
        assert!(floor.disc_passes([0.1, 0.5], [0.39, 0.5], 0.0));
        assert!(floor.disc_passes([0.1, 0.1], [0.9, 0.1], 0.0));
        assert!(floor.disc_passes([0.3, 0.1], [0.3, 0.9], 0.0));
    }

    #[test]
    fn a_body_hangs_over_forbidden_terrain_but_its_centre_stays_out() {
        let mut forbidden = vec![false; 25];
        forbidden[2 * 5 + 2] = true;
        let floor = drawn(&["....."; 5], 0.2).forbidding(forbidden).unwrap();
        assert!(floor.is_forbidden([0.5, 0.5]) && !floor.is_forbidden([0.5, 0.7]));
        assert!(floor.leg_is_clear([0.3, 0.3], [0.3, 0.7], 0.3));
        assert!(!floor.leg_is_clear([0.3, 0.5], [0.7, 0.5], 0.1));
        assert!(!floor.leg_is_clear([0.3, 0.5], [0.5, 0.7], 0.1));
        assert!(floor.disc_passes([0.3, 0.5], [0.7, 0.5], 0.1));
        assert!(drawn(&["."; 2], 0.2).forbidding(vec![true; 3]).is_err());
    }

    #[test]
    fn a_centre_at_the_edge_of_forbidden_terrain_leaves_it_and_does_not_enter() {
        let mut forbidden = vec![false; 25];
        forbidden[2 * 5 + 2] = true;
        let floor = drawn(&["....."; 5], 0.25).forbidding(forbidden).unwrap();
        let edge = [0.625, 0.75];
        assert!(!floor.is_forbidden(edge));
        assert!(floor.centre_passes(edge, [0.625, 1.0]));
        assert!(floor.centre_passes(edge, [1.0, 0.8]));
        assert!(!floor.centre_passes(edge, [0.625, 0.625]));
        assert!(!floor.centre_passes([0.625, 1.0], [0.625, 0.6]));
    }

    #[test]
    fn crossing_segments_have_no_distance() {
        let cross = segment_distance([[0.0, 0.0], [2.0, 2.0]], [[0.0, 2.0], [2.0, 0.0]]);
        assert_eq!(cross, 0.0);
        let parallel = segment_distance([[0.0, 0.0], [2.0, 0.0]], [[1.0, 1.5], [5.0, 1.5]]);
        assert!((parallel - 1.5).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn a_centre_passes_where_it_meets_no_forbidden_square(
            bits in prop::collection::vec(prop::bool::weighted(0.1), 144),
            from in (0.1..2.3_f64, 0.1..2.3_f64), to in (0.1..2.3_f64, 0.1..2.3_f64),
        ) {
            let free = Floor::new(vec![false; 144], 12, 12, 0.2, [0.0, 0.0]).unwrap();
            let floor = free.forbidding(bits.clone()).unwrap();
            // The distance of a thousand points of the leg to every forbidden square.
            let nearest = (0..=1000).flat_map(|step| {
                let ratio = f64::from(step) / 1000.0;
                let (x, y) = (from.0 + ratio * (to.0 - from.0), from.1 + ratio * (to.1 - from.1));
                bits.iter().enumerate().filter(|(_, out)| **out).map(move |(at, _)| {
                    let (left, bottom) = ((at % 12) as f64 * 0.2, (at / 12) as f64 * 0.2);
                    let dx = (left - x).max(x - left - 0.2).max(0.0);
                    let dy = (bottom - y).max(y - bottom - 0.2).max(0.0);
                    dx.hypot(dy)
                })
            }).fold(f64::INFINITY, f64::min);
            let passes = floor.centre_passes([from.0, from.1], [to.0, to.1]);
            if nearest > TERRAIN_GAP_M + LEG_TOLERANCE_M {
                prop_assert!(passes);
            }
            // Samples of the sweep may be a tolerance apart and miss the tip of a corner that is no deeper.
            let deep = (0..=1000).any(|step| {
                let ratio = f64::from(step) / 1000.0;
                let (x, y) = (from.0 + ratio * (to.0 - from.0), from.1 + ratio * (to.1 - from.1));
                bits.iter().enumerate().filter(|(_, out)| **out).any(|(at, _)| {
                    let (left, bottom) = ((at % 12) as f64 * 0.2, (at / 12) as f64 * 0.2);
                    let inset = LEG_TOLERANCE_M;
                    x > left + inset && x < left + 0.2 - inset && y > bottom + inset && y < bottom + 0.2 - inset
                })
            });
            if deep {
                prop_assert!(!passes);
            }
        }

        #[test]
        fn clearance_is_the_distance_to_the_nearest_square(
            bits in prop::collection::vec(prop::bool::weighted(0.1), 144), x in 0.0..2.4_f64, y in 0.0..2.4_f64, limit in 0.1..3.0_f64,
        ) {
            let floor = Floor::new(bits.clone(), 12, 12, 0.2, [0.0, 0.0]).unwrap();
            let border = x.min(y).min(2.4 - x).min(2.4 - y);
            let truth = (0..144).filter(|&at| bits[at]).map(|at| {
                let (left, bottom) = ((at % 12) as f64 * 0.2, (at / 12) as f64 * 0.2);
                let dx = (left - x).max(x - left - 0.2).max(0.0);
                let dy = (bottom - y).max(y - bottom - 0.2).max(0.0);
                dx.hypot(dy)
            }).fold(border, f64::min);
            prop_assert!((floor.clearance([x, y], limit) - truth.min(limit)).abs() < 1e-6);
            prop_assert!(floor.certain_clearance([x, y]) <= truth + 1e-6);
        }
    }
}
