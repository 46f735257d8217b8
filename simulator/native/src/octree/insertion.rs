//! Which voxels one scan observes free and occupied (Wurm, section 5.2.2).
//!
//! A voxel is updated at most once per scan, and an end point wins over beams passing through, so a scan is
//! first drawn into two bits a voxel and only then added to the map.

use crate::octree::brick::{BUCKET_BYTES, Brick};
use crate::octree::key::{BrickKey, Lattice, VOXELS, VoxelKey};
use crate::octree::map::{MapFull, OccupancyMap};
use crate::octree::sensor_model::{SensorModel, UNKNOWN};
use crate::octree::traversal::{norm, walk};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

const WORDS: usize = VOXELS / 64;

/// What a scan says about one brick, one bit a voxel: a word for each z, in it x from the lowest bit, then y.
#[derive(Clone, Debug, Default)]
struct Observed {
    free: [u64; WORDS],
    occupied: [u64; WORDS],
}

/// Word and bit of a voxel.
#[inline]
fn place(voxel: VoxelKey) -> (usize, u64) {
    let [x, y, z] = voxel.0.map(|k| k & 7);
    (z as usize, 1 << (x | y << 3))
}

/// Morton position in a brick of each bit of each word.
const OFFSETS: [[u16; 64]; WORDS] = {
    let spread = [0u16, 1, 8, 9, 64, 65, 72, 73];
    let mut offsets = [[0; 64]; WORDS];
    let mut z = 0;
    while z < WORDS {
        let mut bit = 0;
        while bit < 64 {
            offsets[z][bit] = spread[bit & 7] | spread[bit >> 3] << 1 | spread[z] << 2;
            bit += 1;
        }
        z += 1;
    }
    offsets
};

/// What a scan says about all bricks it touches.
#[derive(Debug, Default)]
struct ScanBricks {
    index: FxHashMap<BrickKey, usize>,
    bricks: Vec<(BrickKey, Observed)>,
    /// Any voxel of the brick touched last, and that brick's position.
    current: Option<(VoxelKey, usize)>,
    /// More bricks than the map could ever hold were touched; the drawing was given up.
    too_many: bool,
}

impl ScanBricks {
    fn position(&mut self, key: BrickKey) -> usize {
        *self.index.entry(key).or_insert_with(|| {
            self.bricks.push((key, Observed::default()));
            self.bricks.len() - 1
        })
    }

    #[inline]
    fn at(&mut self, voxel: VoxelKey) -> &mut Observed {
        // Voxels of a ray come brick by brick: most look-ups end here.
        if let Some((VoxelKey([x, y, z]), position)) = self.current
            && ((voxel.0[0] ^ x) | (voxel.0[1] ^ y) | (voxel.0[2] ^ z)) & !7 == 0
        {
            return &mut self.bricks[position].1;
        }
        let position = self.position(voxel.brick());
        self.current = Some((voxel, position));
        &mut self.bricks[position].1
    }

    #[inline]
    fn free(&mut self, voxel: VoxelKey) {
        let (word, bit) = place(voxel);
        self.at(voxel).free[word] |= bit;
    }

    fn occupied(&mut self, voxel: VoxelKey) {
        let (word, bit) = place(voxel);
        self.at(voxel).occupied[word] |= bit;
    }

    fn merge(mut self, other: Self) -> Self {
        for (key, observed) in other.bricks {
            let position = self.position(key);
            let mine = &mut self.bricks[position].1;
            for word in 0..WORDS {
                mine.free[word] |= observed.free[word];
                mine.occupied[word] |= observed.occupied[word];
            }
        }
        self.too_many |= other.too_many;
        self
    }

    fn draw(
        lattice: &Lattice,
        origin_m: [f32; 3],
        beams: &[[f32; 3]],
        limits: &Limits,
        most_bricks: usize,
    ) -> Self {
        let mut scan = Self::default();
        let max_range_m = limits.max_range_m;
        for &end_m in beams {
            if scan.bricks.len() > most_bricks {
                scan.too_many = true;
                break;
            }
            let origin_m = match &limits.bounds {
                Some(bounds) => match bounds.entry(origin_m, end_m) {
                    Some(entry_m) => entry_m,
                    None => continue,
                },
                None => origin_m,
            };
            let beam: [f32; 3] = std::array::from_fn(|axis| end_m[axis] - origin_m[axis]);
            let length_m = norm(beam);
            match max_range_m {
                Some(limit_m) if f64::from(length_m) > limit_m => {
                    let cut_m = std::array::from_fn(|axis| {
                        origin_m[axis] + beam[axis] / length_m * limit_m as f32
                    });
                    walk(lattice, origin_m, cut_m, |voxel| scan.free(voxel));
                }
                _ => {
                    walk(lattice, origin_m, end_m, |voxel| scan.free(voxel));
                    if let Some(voxel) = lattice.voxel(end_m) {
                        scan.occupied(voxel);
                    }
                }
            }
        }
        scan
    }
}

impl Observed {
    fn apply(&self, brick: &mut Brick, model: &SensorModel) {
        if let Brick::Uniform(value) = *brick {
            let nothing_hit = self.occupied.iter().all(|&word| word == 0);
            // Clamped free space seen free again, the common case indoors, stays as it is.
            if nothing_hit && value == model.lowest {
                return;
            }
        }
        let values = brick.dense();
        for word in 0..WORDS {
            let (mut free, mut occupied) =
                (self.free[word] & !self.occupied[word], self.occupied[word]);
            while free != 0 {
                let value = &mut values[usize::from(OFFSETS[word][free.trailing_zeros() as usize])];
                *value = model.updated(*value, false);
                free &= free - 1;
            }
            while occupied != 0 {
                let value =
                    &mut values[usize::from(OFFSETS[word][occupied.trailing_zeros() as usize])];
                *value = model.updated(*value, true);
                occupied &= occupied - 1;
            }
        }
    }
}

/// Which part of a scan's beams is drawn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Limits {
    /// A longer beam frees the space up to this range and hits nothing [m].
    pub max_range_m: Option<f64>,
    /// Beams that end outside are left out, the others begin where they enter.
    pub bounds: Option<Bounds>,
}

/// A box along the axes of the map frame [m].
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Lowest corner.
    pub low_m: [f32; 3],
    /// Highest corner.
    pub high_m: [f32; 3],
}

impl Bounds {
    /// Where the beam enters the box; `None` if its end point lies outside.
    fn entry(&self, origin_m: [f32; 3], end_m: [f32; 3]) -> Option<[f32; 3]> {
        let mut share = 0.0f32;
        for axis in 0..3 {
            let (low, high) = (self.low_m[axis], self.high_m[axis]);
            if !(low..=high).contains(&end_m[axis]) {
                return None;
            }
            let beam = end_m[axis] - origin_m[axis];
            let border = if origin_m[axis] < low {
                low
            } else if origin_m[axis] > high {
                high
            } else {
                continue;
            };
            share = share.max((border - origin_m[axis]) / beam);
        }
        Some(std::array::from_fn(|axis| {
            origin_m[axis] + share * (end_m[axis] - origin_m[axis])
        }))
    }
}

impl OccupancyMap {
    /// Adds one scan: beams from `origin_m` to each end point, all in the map frame [m].
    ///
    /// Beams with an end that is not finite or out of the map's reach are left out. `threads` share the drawing of
    /// beams; the result does not depend on their number.
    ///
    /// # Errors
    /// If the map would grow beyond its limit; then nothing is changed.
    pub fn insert_scan(
        &mut self,
        origin_m: [f32; 3],
        end_points_m: &[[f32; 3]],
        limits: &Limits,
        threads: usize,
    ) -> Result<(), MapFull> {
        let lattice = self.lattice;
        let most_bricks = self
            .memory_limit_bytes
            .map_or(usize::MAX, |limit_bytes| limit_bytes / BUCKET_BYTES);
        let scan = if threads <= 1 || end_points_m.len() < 4096 {
            ScanBricks::draw(&lattice, origin_m, end_points_m, limits, most_bricks)
        } else {
            end_points_m
                .par_chunks(end_points_m.len().div_ceil(threads))
                .map(|beams| ScanBricks::draw(&lattice, origin_m, beams, limits, most_bricks))
                .reduce_with(ScanBricks::merge)
                .unwrap_or_default()
        };
        if let (true, Some(limit_bytes)) = (scan.too_many, self.memory_limit_bytes) {
            return Err(MapFull { limit_bytes });
        }
        if self.memory_limit_bytes.is_some() {
            self.scan_has_room(&scan)?;
        }
        let model = self.model;
        for (key, observed) in &scan.bricks {
            self.occupancy
                .change(*key, |brick| observed.apply(brick, &model));
        }
        Ok(())
    }

    /// Counts the bricks that a scan makes and those that it makes dense; exactly, where a generous estimate does not fit.
    fn scan_has_room(&self, scan: &ScanBricks) -> Result<(), MapFull> {
        let absent = |(key, _): &&(BrickKey, Observed)| self.occupancy.get(*key).is_none();
        let new = scan.bricks.iter().filter(absent).count();
        if self.has_room(new, scan.bricks.len()).is_ok() {
            return Ok(());
        }
        let is_dense = |brick: &Brick| usize::from(matches!(brick, Brick::Dense(_)));
        let (mut more, mut fewer) = (0, 0);
        for (key, observed) in &scan.bricks {
            let before = self.occupancy.get(*key);
            let mut after = before.cloned().unwrap_or(Brick::Uniform(UNKNOWN));
            observed.apply(&mut after, &self.model);
            after.collapse();
            more += is_dense(&after);
            fewer += before.map_or(0, is_dense);
        }
        self.has_room(new, more.saturating_sub(fewer))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> OccupancyMap {
        OccupancyMap::new(0.1, SensorModel::thesis())
    }

    fn stored(map: &OccupancyMap, point: [f32; 3]) -> i8 {
        map.occupancy.value(map.lattice.voxel(point).unwrap())
    }

    #[test]
    fn an_end_point_wins_over_beams_of_the_same_scan() {
        let mut map = map();
        let wall = [1.05, 0.05, 0.05];
        map.insert_scan(
            [0.05; 3],
            &[wall, [2.05, 0.05, 0.05], wall],
            &Limits::default(),
            1,
        )
        .unwrap();
        assert_eq!(stored(&map, wall), map.model.hit);
        assert_eq!(stored(&map, [0.55, 0.05, 0.05]), map.model.miss);
        assert_eq!(stored(&map, [3.05, 0.05, 0.05]), UNKNOWN);
    }

    #[test]
    fn a_beam_beyond_the_range_frees_space_and_hits_nothing() {
        let mut map = map();
        let limits = Limits {
            max_range_m: Some(2.0),
            bounds: None,
        };
        map.insert_scan([0.05; 3], &[[5.05, 0.05, 0.05]], &limits, 1)
            .unwrap();
        assert_eq!(stored(&map, [1.55, 0.05, 0.05]), map.model.miss);
        assert_eq!(stored(&map, [2.55, 0.05, 0.05]), UNKNOWN);
        assert_eq!(stored(&map, [5.05, 0.05, 0.05]), UNKNOWN);
    }

    #[test]
    fn threads_draw_the_same_map() {
        let beams: Vec<[f32; 3]> = (0..20_000)
            .map(|i| {
                let angle = i as f32 * 0.01;
                [4.0 * angle.cos(), 4.0 * angle.sin(), (i % 97) as f32 * 0.03]
            })
            .collect();
        let (mut one, mut two) = (map(), map());
        for _ in 0..2 {
            let limits = Limits {
                max_range_m: Some(10.0),
                bounds: None,
            };
            one.insert_scan([0.01; 3], &beams, &limits, 1).unwrap();
            two.insert_scan([0.01; 3], &beams, &limits, 2).unwrap();
        }
        assert_eq!(one.occupancy.sorted_keys(), two.occupancy.sorted_keys());
        for (key, brick) in one.occupancy.iter() {
            for offset in 0..VOXELS {
                assert_eq!(brick.value(offset), two.occupancy.value(key.voxel(offset)));
            }
        }
    }

    #[test]
    fn a_scan_that_does_not_fit_changes_nothing() {
        let beams: Vec<[f32; 3]> = (0..5000)
            .map(|i| {
                let angle = i as f32 * 0.01;
                [4.0 * angle.cos(), 4.0 * angle.sin(), (i % 97) as f32 * 0.03]
            })
            .collect();
        let mut free = map();
        free.insert_scan([0.01; 3], &beams, &Limits::default(), 1)
            .unwrap();
        let needed = free.memory_bytes();
        for (limit, fits) in [(needed - 1, false), (needed, true)] {
            let mut bounded = map();
            bounded.memory_limit_bytes = Some(limit);
            let outcome = bounded.insert_scan([0.01; 3], &beams, &Limits::default(), 1);
            assert_eq!(outcome.is_ok(), fits, "{limit}");
            assert_eq!(bounded.occupancy.is_empty(), !fits);
            assert!(bounded.memory_bytes() <= limit);
        }
    }

    #[test]
    fn beams_that_are_not_numbers_are_left_out() {
        let mut map = map();
        map.insert_scan(
            [0.0; 3],
            &[[f32::NAN, 0.0, 0.0], [f32::INFINITY, 0.0, 0.0]],
            &Limits::default(),
            1,
        )
        .unwrap();
        assert!(map.occupancy.is_empty());
    }
}
