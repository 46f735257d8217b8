//! Bricks of 512 voxels and the hashed grid of them.

use crate::octree::key::{BrickKey, VOXELS, VoxelKey};
use crate::octree::sensor_model::UNKNOWN;
use rustc_hash::FxHashMap;

/// A brick whose voxels all agree takes no more than its place in the hash table (lossless pruning).
#[derive(Clone, Debug)]
pub enum Brick {
    /// All voxels have this value.
    Uniform(i8),
    /// One value a voxel, in Morton order.
    Dense(Box<[i8; VOXELS]>),
}

impl Brick {
    /// The value at a Morton position.
    #[inline]
    #[must_use]
    pub fn value(&self, offset: usize) -> i8 {
        match self {
            Self::Uniform(value) => *value,
            Self::Dense(values) => values[offset],
        }
    }

    /// All values, expanding a uniform brick (regeneration).
    pub fn dense(&mut self) -> &mut [i8; VOXELS] {
        if let Self::Uniform(value) = *self {
            *self = Self::Dense(Box::new([value; VOXELS]));
        }
        match self {
            Self::Dense(values) => values,
            Self::Uniform(_) => unreachable!("expanded above"),
        }
    }

    /// Collapses a brick whose voxels all agree.
    pub fn collapse(&mut self) {
        if let Self::Dense(values) = self {
            let first = values[0];
            if values.iter().all(|&value| value == first) {
                *self = Self::Uniform(first);
            }
        }
    }
}

/// A place in the hash table with its control byte.
pub const BUCKET_BYTES: usize = size_of::<(BrickKey, Brick)>() + 1;

/// Bricks by position; a brick that is absent is unknown throughout.
#[derive(Clone, Debug, Default)]
pub struct BrickGrid {
    bricks: FxHashMap<BrickKey, Brick>,
    dense: usize,
}

impl BrickGrid {
    /// The value of a voxel.
    #[must_use]
    pub fn value(&self, voxel: VoxelKey) -> i8 {
        self.get(voxel.brick())
            .map_or(UNKNOWN, |brick| brick.value(voxel.offset()))
    }

    /// A brick.
    #[inline]
    #[must_use]
    pub fn get(&self, key: BrickKey) -> Option<&Brick> {
        self.bricks.get(&key)
    }

    /// Changes one brick, which is created, collapsed and forgotten as its content asks for.
    pub fn change(&mut self, key: BrickKey, change: impl FnOnce(&mut Brick)) {
        let brick = self.bricks.entry(key).or_insert(Brick::Uniform(UNKNOWN));
        let was_dense = matches!(brick, Brick::Dense(_));
        change(brick);
        brick.collapse();
        let is_dense = matches!(brick, Brick::Dense(_));
        let empty = matches!(brick, Brick::Uniform(UNKNOWN));
        self.dense = self.dense + usize::from(is_dense) - usize::from(was_dense);
        if empty {
            self.bricks.remove(&key);
        }
    }

    /// Sets one voxel.
    pub fn set(&mut self, voxel: VoxelKey, value: i8) {
        self.change(voxel.brick(), |brick| brick.dense()[voxel.offset()] = value);
    }

    /// All bricks, in no particular order.
    pub fn iter(&self) -> impl Iterator<Item = (BrickKey, &Brick)> {
        self.bricks.iter().map(|(&key, brick)| (key, brick))
    }

    /// Keys of all bricks, sorted.
    #[must_use]
    pub fn sorted_keys(&self) -> Vec<BrickKey> {
        let mut keys: Vec<BrickKey> = self.bricks.keys().copied().collect();
        keys.sort_unstable();
        keys
    }

    /// Number of bricks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bricks.len()
    }

    /// Whether nothing was observed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bricks.is_empty()
    }

    /// Bytes held: hash table (with its one control byte a bucket) and dense bricks.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        let buckets = self.bricks.capacity() * 8 / 7;
        buckets * BUCKET_BYTES + self.dense * VOXELS
    }

    /// Bytes that would be held with so many more bricks and so many more of them dense.
    #[must_use]
    pub fn memory_bytes_with(&self, more_bricks: usize, more_dense: usize) -> usize {
        let bricks = self.bricks.len() + more_bricks;
        let capacity = if bricks <= self.bricks.capacity() {
            self.bricks.capacity()
        } else {
            (bricks * 8 / 7).next_power_of_two() * 7 / 8
        };
        capacity * 8 / 7 * BUCKET_BYTES + (self.dense + more_dense) * VOXELS
    }

    /// Number of bricks that hold a value for each voxel.
    #[must_use]
    pub fn dense_count(&self) -> usize {
        self.dense
    }

    /// Forgets all bricks that `keep` does not hold on to, and gives their memory back.
    pub fn retain(&mut self, mut keep: impl FnMut(BrickKey) -> bool) {
        self.bricks.retain(|&key, _| keep(key));
        self.bricks.shrink_to_fit();
        self.dense = self
            .bricks
            .values()
            .filter(|brick| matches!(brick, Brick::Dense(_)))
            .count();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreeing_bricks_collapse_and_are_regenerated() {
        let mut grid = BrickGrid::default();
        let key = BrickKey::new([1, -2, 3]);
        grid.change(key, |brick| brick.dense().fill(5));
        assert!(matches!(grid.get(key), Some(Brick::Uniform(5))));
        let voxel = key.voxel(77);
        grid.set(voxel, 6);
        assert!(matches!(grid.get(key), Some(Brick::Dense(_))));
        assert_eq!(grid.value(voxel), 6);
        assert_eq!(grid.value(key.voxel(78)), 5);
        grid.set(voxel, 5);
        assert!(matches!(grid.get(key), Some(Brick::Uniform(5))));
        grid.change(key, |brick| brick.dense().fill(UNKNOWN));
        assert!(grid.is_empty());
    }
}
