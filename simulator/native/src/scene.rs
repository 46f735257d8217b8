//! Distances along beams to the solids of a 3D scene: upright boxes and cylinders.

use rayon::prelude::*;

/// Beams start this far outside of what they leave [m].
const SKIN_M: f64 = 1e-9;

/// A box turned about the vertical.
#[derive(Clone, Copy, Debug)]
pub struct SolidBox {
    /// Centre [m], map frame.
    pub centre_m: [f64; 3],
    /// Half the edges [m].
    pub half_m: [f64; 3],
    /// Cosine and sine of the turn about z.
    pub turn: [f64; 2],
}

/// An upright cylinder without thickness, open at the top unless closed: a cup or a can.
#[derive(Clone, Copy, Debug)]
pub struct Cylinder {
    /// Centre of the bottom [m], map frame.
    pub base_m: [f64; 3],
    /// Radius [m].
    pub radius_m: f64,
    /// Height [m].
    pub height_m: f64,
    /// With a lid.
    pub closed: bool,
}

impl SolidBox {
    /// Distance to the surface, entering from outside or leaving from inside; infinite if missed.
    #[inline]
    #[must_use]
    pub fn distance_m(&self, origin_m: [f64; 3], direction: [f64; 3]) -> f64 {
        let [cosine, sine] = self.turn;
        let into = |v: [f64; 3]| {
            [
                cosine * v[0] + sine * v[1],
                cosine * v[1] - sine * v[0],
                v[2],
            ]
        };
        let start = into(std::array::from_fn(|axis| {
            origin_m[axis] - self.centre_m[axis]
        }));
        let along = into(direction);
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            if along[axis] == 0.0 {
                if start[axis].abs() > self.half_m[axis] {
                    return f64::INFINITY;
                }
                continue;
            }
            let first = (-self.half_m[axis] - start[axis]) / along[axis];
            let second = (self.half_m[axis] - start[axis]) / along[axis];
            near = near.max(first.min(second));
            far = far.min(first.max(second));
        }
        if near > far || far <= SKIN_M {
            f64::INFINITY
        } else if near > SKIN_M {
            near
        } else {
            far
        }
    }
}

impl Cylinder {
    /// Distance to the wall, the bottom or the lid; infinite if missed.
    #[inline]
    #[must_use]
    pub fn distance_m(&self, origin_m: [f64; 3], direction: [f64; 3]) -> f64 {
        let start: [f64; 3] = std::array::from_fn(|axis| origin_m[axis] - self.base_m[axis]);
        let mut best = f64::INFINITY;
        let across = direction[0] * direction[0] + direction[1] * direction[1];
        let half = direction[0] * start[0] + direction[1] * start[1];
        let root = half * half
            - across * (start[0] * start[0] + start[1] * start[1] - self.radius_m * self.radius_m);
        if root >= 0.0 && across > 0.0 {
            for sign in [-1.0, 1.0] {
                let wall = (-half + sign * root.sqrt()) / across;
                let z = start[2] + wall * direction[2];
                if wall > SKIN_M && (0.0..=self.height_m).contains(&z) && wall < best {
                    best = wall;
                }
            }
        }
        if direction[2] != 0.0 {
            let levels = [0.0, self.height_m];
            for &level in &levels[..if self.closed { 2 } else { 1 }] {
                let disc = (level - start[2]) / direction[2];
                let x = start[0] + disc * direction[0];
                let y = start[1] + disc * direction[1];
                if disc > SKIN_M && x * x + y * y <= self.radius_m * self.radius_m && disc < best {
                    best = disc;
                }
            }
        }
        best
    }
}

/// Boxes and cylinders; a solid's number counts boxes first.
#[derive(Clone, Debug, Default)]
pub struct Solids {
    /// Boxes.
    pub boxes: Vec<SolidBox>,
    /// Cylinders.
    pub cylinders: Vec<Cylinder>,
}

impl Solids {
    /// Distance along each unit direction to the nearest solid and its number; infinite and -1 where nothing is.
    #[must_use]
    pub fn cast(
        &self,
        origin_m: [f64; 3],
        directions: &[[f64; 3]],
        threads: usize,
    ) -> Vec<(f64, i32)> {
        let first = |&direction: &[f64; 3]| {
            let mut best = (f64::INFINITY, -1);
            let boxes = self
                .boxes
                .iter()
                .map(|solid| solid.distance_m(origin_m, direction));
            let cylinders = self
                .cylinders
                .iter()
                .map(|solid| solid.distance_m(origin_m, direction));
            for (number, distance_m) in boxes.chain(cylinders).enumerate() {
                if distance_m < best.0 {
                    best = (distance_m, number as i32);
                }
            }
            best
        };
        if threads <= 1 {
            directions.iter().map(first).collect()
        } else {
            directions.par_iter().map(first).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_solid_is_named() {
        let solids = Solids {
            boxes: vec![SolidBox {
                centre_m: [3.0, 0.0, 0.0],
                half_m: [1.0, 0.5, 0.5],
                turn: [1.0, 0.0],
            }],
            cylinders: vec![Cylinder {
                base_m: [1.0, 0.0, -0.1],
                radius_m: 0.1,
                height_m: 0.2,
                closed: false,
            }],
        };
        let cast = solids.cast([0.0; 3], &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 1);
        assert!((cast[0].0 - 0.9).abs() < 1e-12 && cast[0].1 == 1);
        assert_eq!(cast[1], (f64::INFINITY, -1));
        let from_within = solids.cast([3.0, 0.0, 0.0], &[[1.0, 0.0, 0.0]], 1);
        assert_eq!(from_within, [(1.0, 0)]);
    }
}
