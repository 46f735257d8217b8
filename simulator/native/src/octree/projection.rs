//! Columns of a height band seen from above: slices and traversability for planners in the plane.

use crate::octree::brick::Brick;
use crate::octree::key::{BrickKey, EDGE, VoxelKey};
use crate::octree::map::OccupancyMap;
use crate::octree::sensor_model::UNKNOWN;

/// Largest log odds in each column of a band of voxels.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    /// Voxel coordinates x and y of the first column.
    pub corner: [i32; 2],
    /// Columns along x.
    pub width: usize,
    /// Columns along y.
    pub height: usize,
    /// Stored values, row after row from the smallest y; `UNKNOWN` where nothing in the band is known.
    pub values: Vec<i8>,
}

impl OccupancyMap {
    /// The largest stored value of each column over `low_z..=high_z`, within `columns` (lowest and highest x and y),
    /// or over the whole map.
    #[must_use]
    pub fn project(
        &self,
        low_z: i32,
        high_z: i32,
        columns: Option<([i32; 2], [i32; 2])>,
    ) -> Projection {
        let in_band = |key: BrickKey| {
            let z = key.coordinates()[2] * EDGE;
            z <= high_z && z + EDGE > low_z
        };
        let (low, high) = columns.unwrap_or_else(|| {
            self.occupancy.iter().filter(|(key, _)| in_band(*key)).fold(
                ([i32::MAX; 2], [i32::MIN; 2]),
                |(mut low, mut high), (key, _)| {
                    let coordinates = key.coordinates();
                    for axis in 0..2 {
                        low[axis] = low[axis].min(coordinates[axis] * EDGE);
                        high[axis] = high[axis].max(coordinates[axis] * EDGE + EDGE - 1);
                    }
                    (low, high)
                },
            )
        });
        if (0..2).any(|axis| low[axis] > high[axis]) || low_z > high_z {
            return Projection {
                corner: [0; 2],
                width: 0,
                height: 0,
                values: Vec::new(),
            };
        }
        let size: [usize; 2] = std::array::from_fn(|axis| (high[axis] - low[axis] + 1) as usize);
        let mut values = vec![UNKNOWN; size[0] * size[1]];
        for (key, brick) in self.occupancy.iter() {
            if !in_band(key) {
                continue;
            }
            let corner = key.coordinates().map(|k| k * EDGE);
            let first: [i32; 2] = std::array::from_fn(|axis| corner[axis].max(low[axis]));
            let last: [i32; 2] =
                std::array::from_fn(|axis| (corner[axis] + EDGE - 1).min(high[axis]));
            let zs = corner[2].max(low_z)..=(corner[2] + EDGE - 1).min(high_z);
            for y in first[1]..=last[1] {
                for x in first[0]..=last[0] {
                    let highest = match brick {
                        Brick::Uniform(value) => *value,
                        Brick::Dense(values) => zs
                            .clone()
                            .map(|z| values[VoxelKey([x, y, z]).offset()])
                            .max()
                            .unwrap_or(UNKNOWN),
                    };
                    let column =
                        &mut values[(y - low[1]) as usize * size[0] + (x - low[0]) as usize];
                    // UNKNOWN is the smallest byte, so the maximum of known values wins.
                    *column = (*column).max(highest);
                }
            }
        }
        Projection {
            corner: low,
            width: size[0],
            height: size[1],
            values,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octree::key::VOXELS;
    use crate::octree::sensor_model::SensorModel;
    use proptest::prelude::*;

    #[test]
    fn an_empty_band_has_no_columns() {
        let map = OccupancyMap::new(0.1, SensorModel::thesis());
        assert!(map.project(0, 10, None).values.is_empty());
        assert_eq!(
            map.project(0, 10, Some(([0, 0], [2, 1]))).values,
            [UNKNOWN; 6]
        );
    }

    proptest! {
        #[test]
        fn columns_hold_the_largest_value_of_their_voxels(
            voxels in prop::collection::vec((prop::array::uniform3(-12i32..12), -40i8..70), 1..150),
            block in prop::array::uniform3(-2i32..2), value in -40i8..70,
            low_z in -10i32..5, thickness in 0i32..12,
        ) {
            let mut map = OccupancyMap::new(1.0, SensorModel::thesis());
            map.occupancy.change(BrickKey::new(block), |brick| *brick = Brick::Uniform(value));
            for (key, value) in voxels {
                map.occupancy.set(VoxelKey(key), value);
            }
            let seen = map.project(low_z, low_z + thickness, None);
            let mut known = 0;
            for y in 0..seen.height {
                for x in 0..seen.width {
                    let at = |z| map.occupancy.value(VoxelKey([seen.corner[0] + x as i32, seen.corner[1] + y as i32, z]));
                    let expected = (low_z..=low_z + thickness).map(at).max().unwrap();
                    prop_assert_eq!(seen.values[y * seen.width + x], expected);
                    known += (low_z..=low_z + thickness).filter(|&z| at(z) != UNKNOWN).count();
                }
            }
            let all: usize = map.occupancy.iter().map(|(key, brick)| {
                (0..VOXELS).filter(|&offset| brick.value(offset) != UNKNOWN
                    && (low_z..=low_z + thickness).contains(&key.voxel(offset).0[2])).count()
            }).sum();
            prop_assert_eq!(known, all);
        }
    }
}
