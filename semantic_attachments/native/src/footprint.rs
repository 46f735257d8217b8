//! Whether a robot's outline touches obstacles: exact tests of a disc or convex polygon against cell squares.
//!
//! Coordinates are in cells: cell (row, column) is the square from (column, row) to (column + 1, row + 1).
//! Source of the polygon test: separating axes, Gottschalk, Lin and Manocha, "OBBTree", SIGGRAPH 1996.

use crate::shape::Shape;

/// Touching is allowed: overlaps below this many cells do not count.
const TOUCH: f64 = 1e-9;

/// A robot's outline around its reference point.
#[derive(Clone, Debug)]
pub enum Outline {
    /// A disc of a radius in cells.
    Disc(f64),
    /// A convex polygon, counter-clockwise, x ahead of the robot.
    Polygon(Vec<[f64; 2]>),
}

/// Position and heading [rad].
pub type Pose = [f64; 3];

impl Outline {
    /// Largest distance of the outline from the reference point.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match self {
            Self::Disc(radius) => *radius,
            Self::Polygon(corners) => corners.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max),
        }
    }

    /// The outline at a pose.
    #[must_use]
    pub fn placed(&self, [x, y, heading]: Pose) -> Placed {
        match self {
            Self::Disc(radius) => Placed::Disc {
                x,
                y,
                radius: *radius,
            },
            Self::Polygon(corners) => {
                let (sine, cosine) = heading.sin_cos();
                let at =
                    |&[u, v]: &[f64; 2]| [x + cosine * u - sine * v, y + sine * u + cosine * v];
                Placed::Polygon(corners.iter().map(at).collect())
            }
        }
    }
}

/// An outline at a pose.
#[derive(Clone, Debug)]
pub enum Placed {
    /// A disc.
    Disc {
        /// Centre.
        x: f64,
        /// Centre.
        y: f64,
        /// Radius.
        radius: f64,
    },
    /// Corners, counter-clockwise.
    Polygon(Vec<[f64; 2]>),
}

impl Placed {
    /// (x from, y from, x to, y to) of a box around the outline.
    fn bounds(&self) -> [f64; 4] {
        match self {
            Self::Disc { x, y, radius } => [x - radius, y - radius, x + radius, y + radius],
            Self::Polygon(corners) => corners.iter().fold(
                [
                    f64::INFINITY,
                    f64::INFINITY,
                    f64::NEG_INFINITY,
                    f64::NEG_INFINITY,
                ],
                |[a, b, c, d], &[x, y]| [a.min(x), b.min(y), c.max(x), d.max(y)],
            ),
        }
    }

    /// Whether the outline overlaps the square of a cell.
    #[must_use]
    pub fn overlaps(&self, row: i64, column: i64) -> bool {
        let (middle_x, middle_y) = (column as f64 + 0.5, row as f64 + 0.5);
        match self {
            Self::Disc { x, y, radius } => {
                let right = ((x - middle_x).abs() - 0.5).max(0.0);
                let up = ((y - middle_y).abs() - 0.5).max(0.0);
                right.hypot(up) < radius - TOUCH || (right == 0.0 && up == 0.0)
            }
            Self::Polygon(corners) => {
                let [left, low, right, high] = self.bounds();
                let apart = middle_x - 0.5 >= right - TOUCH
                    || middle_x + 0.5 <= left + TOUCH
                    || middle_y - 0.5 >= high - TOUCH
                    || middle_y + 0.5 <= low + TOUCH;
                !apart
                    && (0..corners.len()).all(|index| {
                        let [x0, y0] = corners[index];
                        let [x1, y1] = corners[(index + 1) % corners.len()];
                        let length = (x1 - x0).hypot(y1 - y0);
                        // The outward normal of a counter-clockwise edge.
                        let (normal_x, normal_y) = ((y1 - y0) / length, (x0 - x1) / length);
                        let outside = (middle_x - x0) * normal_x + (middle_y - y0) * normal_y
                            - 0.5 * (normal_x.abs() + normal_y.abs());
                        outside < -TOUCH
                    })
            }
        }
    }
}

/// The obstacles of a map, for one outline.
#[derive(Clone, Debug)]
pub struct Footprint {
    shape: Shape,
    outline: Outline,
    solid: Vec<bool>,
    forbidden: Vec<bool>,
    clearance: Vec<f32>,
}

impl Footprint {
    /// `forbidden` cells may be covered, but not by the reference point; `clearance` is a lower bound of the
    /// distance from the centre of each cell to the centre of the nearest solid one, or of one outside of the map.
    #[must_use]
    pub fn new(
        shape: Shape,
        outline: Outline,
        solid: Vec<bool>,
        forbidden: Vec<bool>,
        clearance: Vec<f32>,
    ) -> Self {
        Self {
            shape,
            outline,
            solid,
            forbidden,
            clearance,
        }
    }

    /// Whether the robot can stand at a pose.
    #[must_use]
    pub fn is_free(&self, pose: Pose) -> bool {
        let [x, y, _] = pose;
        let Some(cell) = self.shape.cell(y.floor() as i64, x.floor() as i64) else {
            return false;
        };
        let cell = cell as usize;
        if self.solid[cell] || self.forbidden[cell] {
            return false;
        }
        // From a point to a cell's centre, and from a centre to its square, are at most half a diagonal each.
        if f64::from(self.clearance[cell]) - std::f64::consts::SQRT_2 >= self.outline.reach() {
            return true;
        }
        let placed = self.outline.placed(pose);
        let [left, low, right, high] = placed.bounds();
        let (width, height) = (self.shape.width as f64, self.shape.height as f64);
        if left < -TOUCH || low < -TOUCH || right > width + TOUCH || high > height + TOUCH {
            return false;
        }
        let rows =
            low.floor().max(0.0) as i64..=high.floor().min(self.shape.height as f64 - 1.0) as i64;
        rows.into_iter().all(|row| {
            let columns = left.floor().max(0.0) as i64
                ..=right.floor().min(self.shape.width as f64 - 1.0) as i64;
            columns.into_iter().all(|column| {
                let cell = row as usize * self.shape.width + column as usize;
                !self.solid[cell] || !placed.overlaps(row, column)
            })
        })
    }

    /// Whether the robot overlaps one of a few cells at some of the poses.
    #[must_use]
    pub fn hits(&self, poses: &[Pose], cells: &[u32]) -> bool {
        poses.iter().any(|&pose| {
            let placed = self.outline.placed(pose);
            cells.iter().any(|&cell| {
                let (row, column) = self.shape.row_column(cell);
                placed.overlaps(row, column)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SHAPE: Shape = Shape {
        height: 20,
        width: 20,
    };

    fn box_outline(length: f64, width: f64) -> Outline {
        let (a, b) = (length / 2.0, width / 2.0);
        Outline::Polygon(vec![[-a, -b], [a, -b], [a, b], [-a, b]])
    }

    /// Whether some of many points of the outline's inside lie in the square.
    fn sampled(outline: &Outline, pose: Pose, row: i64, column: i64) -> bool {
        let (sine, cosine) = pose[2].sin_cos();
        let (from_x, to_x, from_y, to_y) = match outline {
            Outline::Disc(radius) => (-radius, *radius, -radius, *radius),
            Outline::Polygon(corners) => {
                (corners[0][0], corners[2][0], corners[0][1], corners[2][1])
            }
        };
        (0..=60).any(|i| {
            (0..=60).any(|j| {
                let u = from_x + (to_x - from_x) * f64::from(i) / 60.0;
                let v = from_y + (to_y - from_y) * f64::from(j) / 60.0;
                let inside = match outline {
                    Outline::Disc(radius) => u.hypot(v) < *radius,
                    Outline::Polygon(_) => true,
                };
                let (x, y) = (
                    pose[0] + cosine * u - sine * v,
                    pose[1] + sine * u + cosine * v,
                );
                inside && x.floor() as i64 == column && y.floor() as i64 == row
            })
        })
    }

    proptest! {
        #[test]
        fn what_a_sampled_outline_covers_overlaps(
            x in 5.0..15.0, y in 5.0..15.0, heading in -3.2..3.2,
            length in 0.5..6.0, width in 0.5..3.0, disc in any::<bool>(),
            row in 0i64..20, column in 0i64..20,
        ) {
            let outline = if disc { Outline::Disc(width) } else { box_outline(length, width) };
            let placed = outline.placed([x, y, heading]);
            if sampled(&outline, [x, y, heading], row, column) {
                prop_assert!(placed.overlaps(row, column));
            } else if placed.overlaps(row, column) {
                // Only a sliver can escape the samples: a larger outline must be seen in the square.
                let larger = match &outline {
                    Outline::Disc(radius) => Outline::Disc(radius + 0.2),
                    Outline::Polygon(_) => box_outline(length + 0.4, width + 0.4),
                };
                prop_assert!(sampled(&larger, [x, y, heading], row, column));
            }
        }

        #[test]
        fn the_clearance_only_saves_work(
            solid in proptest::collection::vec(proptest::bool::weighted(0.03), 400),
            x in 0.0..20.0, y in 0.0..20.0, heading in -3.2..3.2,
        ) {
            let clearance: Vec<f32> = (0..400u32).map(|cell| {
                let (row, column) = SHAPE.row_column(cell);
                // What lies outside of the map counts as solid.
                let border = (row + 1).min(20 - row).min(column + 1).min(20 - column) as f32;
                (0..400u32).filter(|&other| solid[other as usize]).map(|other| {
                    let (r, c) = SHAPE.row_column(other);
                    ((row - r) as f32).hypot((column - c) as f32)
                }).fold(border, f32::min)
            }).collect();
            let none = vec![false; 400];
            let quick = Footprint::new(SHAPE, box_outline(3.0, 1.5), solid.clone(), none.clone(), clearance);
            let slow = Footprint::new(SHAPE, box_outline(3.0, 1.5), solid, none, vec![0.0; 400]);
            prop_assert_eq!(quick.is_free([x, y, heading]), slow.is_free([x, y, heading]));
        }
    }

    #[test]
    fn a_gap_as_wide_as_the_robot_lets_it_through_lengthwise_only() {
        let mut solid = vec![false; 400];
        for row in (0..9).chain(11..20) {
            solid[row * 20 + 10] = true;
        }
        let map = |width| {
            let outline = box_outline(4.0, width);
            Footprint::new(
                SHAPE,
                outline,
                solid.clone(),
                vec![false; 400],
                vec![0.0; 400],
            )
        };
        assert!(map(2.0).is_free([10.5, 10.0, 0.0]));
        assert!(!map(2.1).is_free([10.5, 10.0, 0.0]));
        assert!(!map(2.0).is_free([10.5, 10.0, 1.57]));
        assert!(!map(2.0).is_free([10.5, 10.2, 0.0]));
    }
}
