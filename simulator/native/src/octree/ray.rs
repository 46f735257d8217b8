//! Casting rays into the map.

use crate::octree::brick::Brick;
use crate::octree::key::VoxelKey;
use crate::octree::map::OccupancyMap;
use crate::octree::sensor_model::UNKNOWN;
use crate::octree::traversal::{Traversal, norm};
use rayon::prelude::*;

/// How a ray ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayEnd {
    /// In an occupied voxel.
    Hit,
    /// In an unknown voxel (only where unknown space stops rays).
    Unknown,
    /// At the largest range or at the border of the map's reach.
    Range,
}

/// Where and how a ray ended.
#[derive(Clone, Copy, Debug)]
pub struct RayResult {
    /// How.
    pub end: RayEnd,
    /// Centre of the last voxel [m], map frame.
    pub position_m: [f64; 3],
}

/// A window onto the brick that the ray is in.
pub(crate) struct Cursor<'map> {
    map: &'map OccupancyMap,
    /// Any voxel of the brick.
    within: VoxelKey,
    brick: Option<&'map Brick>,
}

impl<'map> Cursor<'map> {
    pub(crate) fn new(map: &'map OccupancyMap, start: VoxelKey) -> Self {
        Self {
            map,
            within: start,
            brick: map.occupancy.get(start.brick()),
        }
    }

    #[inline]
    pub(crate) fn value(&mut self, voxel: VoxelKey) -> i8 {
        let [x, y, z] = self.within.0;
        if ((voxel.0[0] ^ x) | (voxel.0[1] ^ y) | (voxel.0[2] ^ z)) & !7 != 0 {
            self.within = voxel;
            self.brick = self.map.occupancy.get(voxel.brick());
        }
        self.brick
            .map_or(UNKNOWN, |brick| brick.value(voxel.offset()))
    }
}

impl OccupancyMap {
    /// The first occupied voxel along a ray.
    ///
    /// A voxel is occupied when its log odds are zero or more. With `through_unknown`, unknown voxels are passed
    /// as if they were free. The ray ends where a voxel's centre is farther than `max_range_m` from the origin.
    #[must_use]
    pub fn cast_ray(
        &self,
        origin_m: [f32; 3],
        direction: [f32; 3],
        max_range_m: f64,
        through_unknown: bool,
    ) -> RayResult {
        let length = norm(direction);
        let start = self.lattice.voxel(origin_m);
        let (Some(start), true) = (start, length > 0.0 && length.is_finite()) else {
            return RayResult {
                end: RayEnd::Range,
                position_m: origin_m.map(f64::from),
            };
        };
        let mut cursor = Cursor::new(self, start);
        let mut ray = Traversal::new(
            &self.lattice,
            start,
            origin_m,
            direction.map(|d| d / length),
        );
        let limit_squared = max_range_m * max_range_m;
        // No centre of a voxel that the ray leaves before this can be beyond the range.
        let safe_m = max_range_m - self.lattice.resolution_m;
        let end_in = |ray: &Traversal, end: RayEnd| RayResult {
            end,
            position_m: ray.voxel.0.map(|k| self.lattice.centre_m(k)),
        };
        loop {
            if ray.exit_m() > safe_m && ray.voxel != start {
                let squared: f64 = (0..3)
                    .map(|axis| {
                        (self.lattice.centre_m(ray.voxel.0[axis]) - f64::from(origin_m[axis]))
                            .powi(2)
                    })
                    .sum();
                if squared > limit_squared {
                    return end_in(&ray, RayEnd::Range);
                }
            }
            if !ray.voxel.within_reach() {
                return end_in(&ray, RayEnd::Range);
            }
            match cursor.value(ray.voxel) {
                UNKNOWN if through_unknown => {}
                UNKNOWN => return end_in(&ray, RayEnd::Unknown),
                value if value >= 0 => return end_in(&ray, RayEnd::Hit),
                _ => {}
            }
            ray.advance();
        }
    }

    /// Casts many rays; `threads` share them.
    #[must_use]
    pub fn cast_rays(
        &self,
        rays: &[([f32; 3], [f32; 3])],
        max_range_m: f64,
        through_unknown: bool,
        threads: usize,
    ) -> Vec<RayResult> {
        let cast = |&(origin, direction): &([f32; 3], [f32; 3])| {
            self.cast_ray(origin, direction, max_range_m, through_unknown)
        };
        if threads <= 1 {
            rays.iter().map(cast).collect()
        } else {
            rays.par_iter().map(cast).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octree::insertion::Limits;
    use crate::octree::sensor_model::SensorModel;

    #[test]
    fn a_ray_stops_at_what_the_scan_saw() {
        let mut map = OccupancyMap::new(0.1, SensorModel::thesis());
        let origin = [0.05; 3];
        map.insert_scan(origin, &[[2.05, 0.05, 0.05]], &Limits::default(), 1)
            .unwrap();
        let hit = map.cast_ray(origin, [1.0, 0.0, 0.0], 10.0, false);
        assert_eq!(hit.end, RayEnd::Hit);
        assert!((hit.position_m[0] - 2.05).abs() < 1e-9);
        assert_eq!(
            map.cast_ray(origin, [1.0, 0.0, 0.0], 1.0, false).end,
            RayEnd::Range
        );
        assert_eq!(
            map.cast_ray(origin, [0.0, 1.0, 0.0], 10.0, false).end,
            RayEnd::Unknown
        );
        assert_eq!(
            map.cast_ray(origin, [0.0, 1.0, 0.0], 10.0, true).end,
            RayEnd::Range
        );
        assert_eq!(
            map.cast_ray(origin, [0.0; 3], 10.0, true).end,
            RayEnd::Range
        );
    }
}
