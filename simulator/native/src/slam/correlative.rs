//! Correlative scan matching by branch and bound: the best pose of a window, not a local optimum.
//!
//! Olson, "Real-Time Correlative Scan Matching", ICRA 2009; the bounds from a pyramid of maxima are
//! those of Hess, Kohler, Rapp and Andor, "Real-Time Loop Closure in 2D LIDAR SLAM", ICRA 2016.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::likelihood_field::{LikelihoodField, Pose};
use crate::floor::Point;

/// Deepest pyramid: squares of 2^6 cells.
const LEVELS: usize = 7;

/// Where to look for a scan's pose.
pub struct Window {
    /// Centre of the window.
    pub guess: Pose,
    /// Farthest offset along x and y [m].
    pub reach_m: f64,
    /// Farthest offset of the heading [rad].
    pub reach_rad: f64,
    /// Distance of the headings that are tried [rad].
    pub step_rad: f64,
    /// Mean value per point below which a pose does not count.
    pub least_score: f64,
}

/// Maxima of a field over squares of 2^level cells, their lower left cell the index.
struct Pyramid {
    levels: Vec<LikelihoodField>,
}

impl Pyramid {
    fn new(field: &LikelihoodField, depth: usize) -> Self {
        let mut levels = Vec::with_capacity(depth);
        for level in 0..depth {
            let next = match levels.last() {
                None => pooled(field, 0),
                Some(below) => pooled(below, 1 << (level - 1)),
            };
            levels.push(next);
        }
        Self { levels }
    }
}

/// Maximum of each cell with those `shift` to the right and above; the grid grows by `shift` to the
/// left and below, where squares begin outside that reach in.
fn pooled(field: &LikelihoodField, shift: usize) -> LikelihoodField {
    let (width, height) = (field.width + shift, field.height + shift);
    let s = shift as i64;
    let mut values = Vec::with_capacity(width * height);
    for row in 0..height as i64 {
        for column in 0..width as i64 {
            let (x, y) = (column - s, row - s);
            let below = field.at(x, y).max(field.at(x + s, y));
            let above = field.at(x, y + s).max(field.at(x + s, y + s));
            values.push(below.max(above));
        }
    }
    let back = shift as f64 * field.resolution_m;
    LikelihoodField {
        values,
        width,
        height,
        resolution_m: field.resolution_m,
        origin_m: [field.origin_m[0] - back, field.origin_m[1] - back],
        outside: field.outside,
    }
}

/// A square of offsets for one heading, and the best score that it can hold.
struct Branch {
    bound: f64,
    level: usize,
    heading: usize,
    offset: [i64; 2],
}

impl PartialEq for Branch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Branch {}

impl PartialOrd for Branch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Branch {
    /// The largest bound first, then the finest level; ties in the order of headings and offsets.
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound
            .total_cmp(&other.bound)
            .then_with(|| other.level.cmp(&self.level))
            .then_with(|| other.heading.cmp(&self.heading))
            .then_with(|| other.offset.cmp(&self.offset))
    }
}

impl LikelihoodField {
    /// The pose of the window with the largest mean value over the points, and that value.
    ///
    /// Offsets are multiples of the field's resolution. `None` if no pose reaches the least score.
    pub fn best_pose(&self, points: &[Point], window: &Window) -> Option<(Pose, f64)> {
        if points.is_empty() {
            return None;
        }
        let cells = (window.reach_m / self.resolution_m).ceil() as i64;
        let depth = (1..LEVELS)
            .find(|level| 1_i64 << (level - 1) > cells)
            .unwrap_or(LEVELS);
        let pyramid = Pyramid::new(self, depth);
        let headings = headings(window);
        let looked_up: Vec<Vec<[i64; 2]>> = headings
            .iter()
            .map(|&heading| self.cells_of(points, window.guess, heading))
            .collect();
        let bound = |level: usize, heading: usize, offset: [i64; 2]| {
            pyramid.levels[level].mean(&looked_up[heading], offset, (1_i64 << level) - 1)
        };
        let mut open = BinaryHeap::new();
        let top = depth - 1;
        let side = 1_i64 << top;
        for heading in 0..headings.len() {
            for y in (-cells..=cells).step_by(side as usize) {
                for x in (-cells..=cells).step_by(side as usize) {
                    open.push(Branch {
                        bound: bound(top, heading, [x, y]),
                        level: top,
                        heading,
                        offset: [x, y],
                    });
                }
            }
        }
        while let Some(branch) = open.pop() {
            if branch.bound < window.least_score {
                return None;
            }
            if branch.level == 0 {
                let shift = branch.offset.map(|cells| cells as f64 * self.resolution_m);
                let [x, y, _] = window.guess;
                let pose = [x + shift[0], y + shift[1], headings[branch.heading]];
                return Some((pose, branch.bound));
            }
            let level = branch.level - 1;
            let half = 1_i64 << level;
            for (dx, dy) in [(0, 0), (half, 0), (0, half), (half, half)] {
                let offset = [branch.offset[0] + dx, branch.offset[1] + dy];
                if offset[0] <= cells && offset[1] <= cells {
                    open.push(Branch {
                        bound: bound(level, branch.heading, offset),
                        level,
                        heading: branch.heading,
                        offset,
                    });
                }
            }
        }
        None
    }

    fn cells_of(&self, points: &[Point], guess: Pose, heading: f64) -> Vec<[i64; 2]> {
        let (sine, cosine) = heading.sin_cos();
        let (x, y) = (guess[0] - self.origin_m[0], guess[1] - self.origin_m[1]);
        let cell = |value: f64| (value / self.resolution_m).floor() as i64;
        points
            .iter()
            .map(|&[px, py]| {
                [
                    cell(x + cosine * px - sine * py),
                    cell(y + sine * px + cosine * py),
                ]
            })
            .collect()
    }

    /// Mean value at cells of the finest grid moved by an offset; `grown` cells were added on the
    /// left and below.
    fn mean(&self, cells: &[[i64; 2]], offset: [i64; 2], grown: i64) -> f64 {
        let sum: f32 = cells
            .iter()
            .map(|&[column, row]| self.at(column + offset[0] + grown, row + offset[1] + grown))
            .sum();
        f64::from(sum) / cells.len() as f64
    }
}

/// The guess's heading first, then those beside it in growing distance.
fn headings(window: &Window) -> Vec<f64> {
    let steps = if window.step_rad > 0.0 {
        (window.reach_rad / window.step_rad).ceil() as i64
    } else {
        0
    };
    let mut offsets: Vec<i64> = (-steps..=steps).collect();
    offsets.sort_by_key(|offset| (offset.abs(), *offset));
    offsets
        .into_iter()
        .map(|offset| window.guess[2] + offset as f64 * window.step_rad)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn exhaustive(field: &LikelihoodField, points: &[Point], window: &Window) -> f64 {
        let cells = (window.reach_m / field.resolution_m).ceil() as i64;
        let mut best = f64::NEG_INFINITY;
        for heading in headings(window) {
            let looked_up = field.cells_of(points, window.guess, heading);
            for y in -cells..=cells {
                for x in -cells..=cells {
                    best = best.max(field.mean(&looked_up, [x, y], 0));
                }
            }
        }
        best
    }

    proptest! {
        #[test]
        fn finds_what_trying_every_pose_finds(
            walls in prop::collection::vec((0.0..6.0_f64, 0.0..6.0_f64), 5..30),
            seen in prop::collection::vec((-3.0..3.0_f64, -3.0..3.0_f64), 3..12),
            guess in (0.0..6.0_f64, 0.0..6.0_f64, -3.0..3.0_f64),
            reach_m in 0.0..1.7_f64,
        ) {
            let points: Vec<Point> = walls.iter().map(|&(x, y)| [x, y]).collect();
            let field = LikelihoodField::around_points(&points, 0.1, 0.15).unwrap();
            let scan: Vec<Point> = seen.iter().map(|&(x, y)| [x, y]).collect();
            let window = Window {
                guess: [guess.0, guess.1, guess.2],
                reach_m,
                reach_rad: 0.4,
                step_rad: 0.1,
                least_score: 0.0,
            };
            let (_, score) = field.best_pose(&scan, &window).unwrap();
            prop_assert!((score - exhaustive(&field, &scan, &window)).abs() < 1e-6);
        }
    }

    #[test]
    fn a_scan_is_put_back_where_it_was_taken() {
        let walls: Vec<Point> = (0..80)
            .map(|i| f64::from(i) * 0.05)
            .flat_map(|t| [[t, 0.0], [0.0, 0.7 * t]])
            .collect();
        let field = LikelihoodField::around_points(&walls, 0.05, 0.06).unwrap();
        let truth = [2.0, 1.0, 0.3];
        let scan: Vec<Point> = walls
            .iter()
            .map(|&[x, y]| {
                let (dx, dy) = (x - truth[0], y - truth[1]);
                let (sine, cosine) = truth[2].sin_cos();
                [cosine * dx + sine * dy, cosine * dy - sine * dx]
            })
            .collect();
        let window = Window {
            guess: [2.4, 0.7, 0.1],
            reach_m: 0.6,
            reach_rad: 0.3,
            step_rad: 0.02,
            least_score: 0.5,
        };
        let (pose, score) = field.best_pose(&scan, &window).unwrap();
        assert!((pose[0] - 2.0).abs() < 0.06 && (pose[1] - 1.0).abs() < 0.06);
        assert!((pose[2] - 0.3).abs() < 0.03 && score > 0.8);
        let far = Window {
            guess: [9.0, 9.0, 0.0],
            ..window
        };
        assert!(field.best_pose(&scan, &far).is_none());
    }
}
