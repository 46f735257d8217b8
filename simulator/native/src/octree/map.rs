//! The occupancy map: bricks of log odds, and further channels over the same lattice.

use crate::octree::brick::BrickGrid;
use crate::octree::gain::Region;
use crate::octree::key::{BrickKey, Lattice, VOXELS, VoxelKey};
use crate::octree::sensor_model::{SensorModel, UNKNOWN};
use std::collections::BTreeMap;
use std::fmt;

/// A further property of each voxel with log odds of its own, such as vegetation (Wurm, eq. 6.18).
#[derive(Clone, Debug)]
pub struct Channel {
    /// How measurements add up.
    pub model: SensorModel,
    /// Its values.
    pub grid: BrickGrid,
}

/// A 3D occupancy map.
#[derive(Clone, Debug)]
pub struct OccupancyMap {
    /// Between metres and voxels.
    pub lattice: Lattice,
    /// Update of occupancy.
    pub model: SensorModel,
    /// Log odds of occupancy.
    pub occupancy: BrickGrid,
    /// Further channels by name.
    pub channels: BTreeMap<String, Channel>,
    /// Bytes that the map may hold; what would take more is refused.
    pub memory_limit_bytes: Option<usize>,
}

/// A change was refused because the map would grow beyond its limit; the map is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapFull {
    /// Bytes that the map may hold.
    pub limit_bytes: usize,
}

impl fmt::Display for MapFull {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the map would take more than its limit of {} bytes: raise the limit, use coarser voxels, or forget \
             what lies far away",
            self.limit_bytes
        )
    }
}

/// How the voxels below a coarser node are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Combination {
    /// Largest log odds of the known voxels: the conservative choice for navigation (Wurm, eq. 5.11).
    Maximum,
    /// Mean log odds of the known voxels (Wurm, eq. 5.10).
    Mean,
}

impl OccupancyMap {
    /// An empty map.
    #[must_use]
    pub fn new(resolution_m: f64, model: SensorModel) -> Self {
        Self {
            lattice: Lattice::new(resolution_m),
            model,
            occupancy: BrickGrid::default(),
            channels: BTreeMap::new(),
            memory_limit_bytes: None,
        }
    }

    /// Log odds at a point, or of the node `levels` above its voxel; NaN where nothing is known.
    #[must_use]
    pub fn log_odds(&self, point_m: [f32; 3], levels: u32, how: Combination) -> f64 {
        let Some(voxel) = self.lattice.voxel(point_m) else {
            return f64::NAN;
        };
        if levels == 0 {
            return self.model.log_odds(self.occupancy.value(voxel));
        }
        if levels <= 3 {
            let count = 1 << (3 * levels);
            let first = voxel.offset() & !(count - 1);
            let mut summary = Summary::default();
            if let Some(brick) = self.occupancy.get(voxel.brick()) {
                for offset in first..first + count {
                    summary.add(brick.value(offset), 1);
                }
            }
            return summary.log_odds(&self.model, how);
        }
        self.coarse_log_odds(voxel, levels.min(24), how)
    }

    /// A node of whole bricks: walks its bricks, or all bricks of the map where those are fewer.
    fn coarse_log_odds(&self, voxel: VoxelKey, levels: u32, how: Combination) -> f64 {
        let shift = levels - 3;
        let node = voxel.0.map(|k| k >> 3 >> shift);
        let mut summary = Summary::default();
        let mut add = |brick: &crate::octree::brick::Brick| match brick {
            crate::octree::brick::Brick::Uniform(value) => summary.add(*value, VOXELS as u64),
            crate::octree::brick::Brick::Dense(values) => {
                for &value in values.iter() {
                    summary.add(value, 1);
                }
            }
        };
        if 3 * shift < 30 && (1usize << (3 * shift)) <= self.occupancy.len() {
            let edge = 1 << shift;
            for x in 0..edge {
                for y in 0..edge {
                    for z in 0..edge {
                        let corner = node.map(|k| k << shift);
                        let key = BrickKey::new([corner[0] + x, corner[1] + y, corner[2] + z]);
                        if let Some(brick) = self.occupancy.get(key) {
                            add(brick);
                        }
                    }
                }
            }
        } else {
            for (key, brick) in self.occupancy.iter() {
                if key.coordinates().map(|k| k >> shift) == node {
                    add(brick);
                }
            }
        }
        summary.log_odds(&self.model, how)
    }

    /// Whether so many more bricks fit into the map's limit.
    ///
    /// # Errors
    /// If they do not.
    pub fn has_room(&self, more_bricks: usize, more_dense: usize) -> Result<(), MapFull> {
        let channels = self.memory_bytes() - self.occupancy.memory_bytes();
        match self.memory_limit_bytes {
            Some(limit_bytes)
                if channels + self.occupancy.memory_bytes_with(more_bricks, more_dense)
                    > limit_bytes =>
            {
                Err(MapFull { limit_bytes })
            }
            _ => Ok(()),
        }
    }

    /// Forgets every brick that lies wholly outside of a box of voxels, in all channels.
    pub fn forget_outside(&mut self, low: VoxelKey, high: VoxelKey) {
        let keep = |key: BrickKey| {
            let corner = key.coordinates();
            (0..3).all(|axis| corner[axis] >= low.0[axis] >> 3 && corner[axis] <= high.0[axis] >> 3)
        };
        self.occupancy.retain(keep);
        for channel in self.channels.values_mut() {
            channel.grid.retain(keep);
        }
    }

    /// Bytes held by all channels.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.channels
            .values()
            .fold(self.occupancy.memory_bytes(), |sum, channel| {
                sum + channel.grid.memory_bytes()
            })
    }

    /// Known voxels and their stored values, sorted by brick and Morton order; of a region or of the whole map.
    #[must_use]
    pub fn known_voxels(&self, region: Option<Region>) -> (Vec<VoxelKey>, Vec<i8>) {
        let (mut voxels, mut values) = (Vec::new(), Vec::new());
        for key in self.occupancy.sorted_keys() {
            let Some(brick) = self.occupancy.get(key) else {
                continue;
            };
            let corner = key.coordinates().map(|k| k << 3);
            if region.is_some_and(|region| {
                (0..3).any(|axis| {
                    corner[axis] > region.high.0[axis] || corner[axis] + 7 < region.low.0[axis]
                })
            }) {
                continue;
            }
            for offset in 0..VOXELS {
                let value = brick.value(offset);
                if value != UNKNOWN && region.is_none_or(|region| region.holds(key.voxel(offset))) {
                    voxels.push(key.voxel(offset));
                    values.push(value);
                }
            }
        }
        (voxels, values)
    }
}

/// Running maximum and mean of known voxels.
#[derive(Clone, Copy, Debug, Default)]
struct Summary {
    known: u64,
    sum: i64,
    maximum: Option<i8>,
}

impl Summary {
    fn add(&mut self, value: i8, count: u64) {
        if value != UNKNOWN {
            self.known += count;
            self.sum += i64::from(value) * count as i64;
            self.maximum = self.maximum.max(Some(value));
        }
    }

    fn log_odds(&self, model: &SensorModel, how: Combination) -> f64 {
        match (how, self.maximum) {
            (_, None) => f64::NAN,
            (Combination::Maximum, Some(value)) => model.log_odds(value),
            (Combination::Mean, _) => self.sum as f64 / self.known as f64 * model.quantum,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_queries_agree_with_the_voxels_below() {
        let mut map = OccupancyMap::new(1.0, SensorModel::thesis());
        map.occupancy.set(VoxelKey([0, 0, 0]), 10);
        map.occupancy.set(VoxelKey([1, 1, 1]), -20);
        map.occupancy.set(VoxelKey([9, 0, 0]), 30);
        let at = |levels, how| map.log_odds([0.5; 3], levels, how);
        assert!((at(0, Combination::Mean) - 0.5).abs() < 1e-9);
        assert!((at(1, Combination::Maximum) - 0.5).abs() < 1e-9);
        assert!((at(1, Combination::Mean) + 0.25).abs() < 1e-9);
        assert!((at(3, Combination::Mean) + 0.25).abs() < 1e-9);
        assert!((at(4, Combination::Maximum) - 1.5).abs() < 1e-9);
        assert!((at(20, Combination::Mean) - 20.0 / 3.0 * 0.05).abs() < 1e-9);
        assert!(
            map.log_odds([-0.5, 0.5, 0.5], 2, Combination::Mean)
                .is_nan()
        );
    }
}
