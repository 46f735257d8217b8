//! Laser range finding: rays through a floor's walls, blockades and other robots.
//!
//! Walls are met by stepping from cell to cell (Amanatides and Woo, "A Fast Voxel Traversal
//! Algorithm for Ray Tracing", Eurographics 1987), and where the clearance says that nothing is near,
//! by leaping that far. Segments and discs are intersected exactly.

use std::f64::consts::TAU;

use crate::floor::{Floor, Point, Segment, distance, nearest_on_segment};

/// A beam that met nothing, a wall or a robot.
pub const NO_SEGMENT: i32 = -1;

/// What moves or vanishes, and is therefore not part of the floor.
pub struct Obstacles<'a> {
    /// Straight obstacles, reported by their index.
    pub segments: &'a [Segment],
    /// Robots: centre and radius [m].
    pub discs: &'a [(Point, f64)],
}

/// Casts beams spread evenly over the full circle, the first along `heading_rad`.
///
/// `ranges_m[i]` becomes the distance to the first obstacle, or `range_m` if there is none as near;
/// `hits[i]` the index of the segment that was met, or `NO_SEGMENT`.
pub fn scan(
    floor: &Floor,
    obstacles: &Obstacles<'_>,
    origin: Point,
    heading_rad: f64,
    range_m: f64,
    ranges_m: &mut [f32],
    hits: &mut [i32],
) {
    let near_segments: Vec<(usize, Segment)> = obstacles
        .segments
        .iter()
        .copied()
        .enumerate()
        .filter(|&(_, s)| distance(origin, nearest_on_segment(origin, s)) <= range_m)
        .collect();
    let near_discs: Vec<(Point, f64)> = obstacles
        .discs
        .iter()
        .copied()
        .filter(|&(centre, radius)| distance(origin, centre) <= range_m + radius)
        .collect();
    let step = TAU / ranges_m.len() as f64;
    for (i, (range, hit)) in ranges_m.iter_mut().zip(hits).enumerate() {
        let (sine, cosine) = (heading_rad + step * i as f64).sin_cos();
        let direction = [cosine, sine];
        let mut reach = cast(floor, origin, direction, range_m);
        *hit = NO_SEGMENT;
        for &(index, segment) in &near_segments {
            let t = to_segment(origin, direction, segment);
            if t < reach {
                (reach, *hit) = (t, index as i32);
            }
        }
        for &(centre, radius) in &near_discs {
            let t = to_disc(origin, direction, centre, radius);
            if t < reach {
                (reach, *hit) = (t, NO_SEGMENT);
            }
        }
        *range = reach as f32;
    }
}

/// Distance along a unit direction to the first wall, at most `range_m`.
pub fn cast(floor: &Floor, origin: Point, direction: Point, range_m: f64) -> f64 {
    let nudge = 1e-7 * floor.resolution_m;
    let mut travelled = 0.0;
    while travelled < range_m {
        let at = [
            origin[0] + travelled * direction[0],
            origin[1] + travelled * direction[1],
        ];
        let Some((column, row)) = floor.cell(at) else {
            return travelled;
        };
        if floor.is_occupied(column, row) {
            return travelled;
        }
        let free = floor.clearance_at_centre(column, row) - 0.7072 * floor.resolution_m;
        travelled += if free > floor.resolution_m {
            free
        } else {
            leave_cell(floor, at, direction, column, row) + nudge
        };
    }
    range_m
}

/// Distance along a unit direction to the border of the cell that `at` lies in.
fn leave_cell(floor: &Floor, at: Point, direction: Point, column: usize, row: usize) -> f64 {
    let axis = |k: usize, cell: usize| {
        let border = floor.origin_m[k]
            + (cell + usize::from(direction[k] > 0.0)) as f64 * floor.resolution_m;
        if direction[k].abs() < 1e-12 {
            f64::INFINITY
        } else {
            ((border - at[k]) / direction[k]).max(0.0)
        }
    };
    axis(0, column).min(axis(1, row))
}

fn to_segment(origin: Point, direction: Point, [a, b]: Segment) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let offset = [a[0] - origin[0], a[1] - origin[1]];
    let cross = direction[0] * along[1] - direction[1] * along[0];
    if cross.abs() < 1e-12 {
        return f64::INFINITY;
    }
    let t = (offset[0] * along[1] - offset[1] * along[0]) / cross;
    let ratio = (offset[0] * direction[1] - offset[1] * direction[0]) / cross;
    if t >= 0.0 && (0.0..=1.0).contains(&ratio) {
        t
    } else {
        f64::INFINITY
    }
}

fn to_disc(origin: Point, direction: Point, centre: Point, radius: f64) -> f64 {
    let offset = [centre[0] - origin[0], centre[1] - origin[1]];
    let along = offset[0] * direction[0] + offset[1] * direction[1];
    let across = offset[0] * direction[1] - offset[1] * direction[0];
    let squared = radius * radius - across * across;
    if squared < 0.0 {
        return f64::INFINITY;
    }
    let t = along - squared.sqrt();
    if t >= 0.0 { t } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::tests::drawn;
    use proptest::prelude::*;

    fn one_beam(floor: &Floor, obstacles: &Obstacles<'_>, heading: f64) -> (f32, i32) {
        let (mut ranges, mut hits) = ([0.0], [0]);
        scan(
            floor,
            obstacles,
            [1.1, 1.1],
            heading,
            5.0,
            &mut ranges,
            &mut hits,
        );
        (ranges[0], hits[0])
    }

    #[test]
    fn the_nearest_of_wall_blockade_and_robot_counts() {
        let floor = drawn(&[".........#"; 10], 0.2);
        let segments = [[[1.5, 0.5], [1.5, 1.5]]];
        let discs = [([1.4, 1.1], 0.1)];
        let none = Obstacles {
            segments: &[],
            discs: &[],
        };
        assert!((one_beam(&floor, &none, 0.0).0 - 0.7).abs() < 1e-6);
        let blocked = Obstacles {
            segments: &segments,
            discs: &[],
        };
        let (range, hit) = one_beam(&floor, &blocked, 0.0);
        assert!((range - 0.4).abs() < 1e-6 && hit == 0);
        let hidden = Obstacles {
            segments: &segments,
            discs: &discs,
        };
        let (range, hit) = one_beam(&floor, &hidden, 0.0);
        assert!((range - 0.2).abs() < 1e-6 && hit == NO_SEGMENT);
    }

    proptest! {
        /// Against tiny steps along the ray.
        #[test]
        fn agrees_with_marching(bits in prop::collection::vec(prop::bool::weighted(0.08), 400), angle in 0.0..TAU, x in 0.01..3.99_f64, y in 0.01..3.99_f64) {
            let floor = Floor::new(bits, 20, 20, 0.2, [0.0, 0.0]).unwrap();
            let direction = [angle.cos(), angle.sin()];
            let reach = cast(&floor, [x, y], direction, 3.0);
            let free_at = |t: f64| floor
                .cell([x + t * direction[0], y + t * direction[1]])
                .is_some_and(|(column, row)| !floor.is_occupied(column, row));
            let fine = 0.0005;
            let marched = (0..6000).map(|i| f64::from(i) * fine).find(|&t| !free_at(t)).unwrap_or(3.0);
            // Marching may slip past a corner that the ray only grazes, never the other way round.
            prop_assert!(reach <= marched + 1e-6);
            prop_assert!(reach >= 3.0 || !free_at(reach));
        }
    }
}
