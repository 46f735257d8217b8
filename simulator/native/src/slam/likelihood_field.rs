//! Likelihood fields: how well an end point of a beam fits to a map, looked up per cell.
//!
//! Thrun, Burgard and Fox, Probabilistic Robotics (2005), 6.4.

use crate::floor::Point;

/// A pose in the field's frame: x, y [m], heading [rad].
pub type Pose = [f64; 3];

/// One value a cell; row 0 is the bottom one.
pub struct LikelihoodField {
    pub(super) values: Vec<f32>,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) resolution_m: f64,
    /// Lower left corner of cell (0, 0).
    pub(super) origin_m: Point,
    /// Value of everything beyond the grid.
    pub(super) outside: f32,
}

impl LikelihoodField {
    /// Takes `width * height` values, row-major from the bottom.
    pub fn new(
        values: Vec<f32>,
        width: usize,
        height: usize,
        resolution_m: f64,
        origin_m: Point,
        outside: f32,
    ) -> Option<Self> {
        let sound = values.len() == width * height
            && !values.is_empty()
            && resolution_m > 0.0
            && resolution_m.is_finite();
        sound.then_some(Self {
            values,
            width,
            height,
            resolution_m,
            origin_m,
            outside,
        })
    }

    /// Gaussian bumps of height one around points, the larger value where they overlap (Olson,
    /// "Real-Time Correlative Scan Matching", ICRA 2009); zero elsewhere.
    pub fn around_points(points: &[Point], resolution_m: f64, sigma_m: f64) -> Option<Self> {
        let reach = (3.0 * sigma_m / resolution_m).ceil() as i64;
        let margin_m = (reach as f64 + 1.0) * resolution_m;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis] - margin_m);
                high[axis] = high[axis].max(point[axis] + margin_m);
            }
        }
        // The grid's lines lie at multiples of the resolution, wherever the points are.
        let first = low.map(|side| (side / resolution_m).floor() * resolution_m);
        let cells = |axis: usize| ((high[axis] - first[axis]) / resolution_m).ceil() as usize + 1;
        if points.is_empty() || !first.iter().all(|side| side.is_finite()) {
            return None;
        }
        let (width, height) = (cells(0), cells(1));
        let values = vec![0.0; width * height];
        let mut field = Self::new(values, width, height, resolution_m, first, 0.0)?;
        for &point in points {
            field.stamp(point, reach, sigma_m);
        }
        Some(field)
    }

    fn stamp(&mut self, point: Point, reach: i64, sigma_m: f64) {
        let place = [0, 1].map(|axis| (point[axis] - self.origin_m[axis]) / self.resolution_m);
        let (column, row) = (place[0].floor() as i64, place[1].floor() as i64);
        let scale = -0.5 * (self.resolution_m / sigma_m).powi(2);
        for y in row - reach..=row + reach {
            for x in column - reach..=column + reach {
                let offset = [x as f64 + 0.5 - place[0], y as f64 + 0.5 - place[1]];
                let squared = offset[0] * offset[0] + offset[1] * offset[1];
                let value = (scale * squared).exp() as f32;
                let cell = &mut self.values[y as usize * self.width + x as usize];
                *cell = cell.max(value);
            }
        }
    }

    /// Value at a column and a row, which may lie outside.
    pub(super) fn at(&self, column: i64, row: i64) -> f32 {
        let inside = column >= 0
            && row >= 0
            && (column as usize) < self.width
            && (row as usize) < self.height;
        if inside {
            self.values[row as usize * self.width + column as usize]
        } else {
            self.outside
        }
    }

    /// Sum of the values at a scan's end points, for each pose that it may have been taken from.
    pub fn scores(&self, poses: &[Pose], points: &[Point]) -> Vec<f64> {
        let scale = 1.0 / self.resolution_m;
        poses
            .iter()
            .map(|&[x, y, heading]| {
                let (sine, cosine) = heading.sin_cos();
                let (x, y) = (x - self.origin_m[0], y - self.origin_m[1]);
                points
                    .iter()
                    .map(|&[px, py]| {
                        let column = (x + cosine * px - sine * py) * scale;
                        let row = (y + sine * px + cosine * py) * scale;
                        f64::from(self.at(column.floor() as i64, row.floor() as i64))
                    })
                    .sum()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bumps_are_highest_at_their_points() {
        let points = [[0.025, 0.025], [1.025, 0.525]];
        let field = LikelihoodField::around_points(&points, 0.05, 0.1).unwrap();
        let scores = field.scores(
            &[[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [5.0, 0.0, 0.0]],
            &points,
        );
        assert!((scores[0] - 2.0).abs() < 1e-6);
        assert!((scores[1] - 2.0 * (-0.5_f64).exp()).abs() < 1e-5);
        assert!(scores[2].abs() < 1e-9);
    }

    #[test]
    fn a_turned_scan_is_looked_up_where_it_fell() {
        let mut values = vec![0.0; 12];
        values[2 * 4 + 1] = 3.0;
        let field = LikelihoodField::new(values, 4, 3, 1.0, [10.0, 20.0], -1.0).unwrap();
        let quarter = std::f64::consts::FRAC_PI_2;
        let scores = field.scores(
            &[[11.5, 20.5, quarter], [11.5, 20.5, 0.0], [0.0; 3]],
            &[[2.0, 0.0]],
        );
        assert_eq!(scores, [3.0, 0.0, -1.0]);
    }

    #[test]
    fn malformed_fields_are_refused() {
        assert!(LikelihoodField::new(vec![0.0; 3], 2, 2, 0.1, [0.0; 2], 0.0).is_none());
        assert!(LikelihoodField::new(vec![0.0; 4], 2, 2, 0.0, [0.0; 2], 0.0).is_none());
        assert!(LikelihoodField::around_points(&[], 0.05, 0.1).is_none());
    }
}
