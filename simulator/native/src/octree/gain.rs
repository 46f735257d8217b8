//! Expected information gain of viewpoints by ray casting (Wurm, section 5.4, eq. 5.30).
//!
//! Beams pass free voxels, end at occupied ones and are reflected with uniform probability in unknown ones;
//! only unknown voxels contribute. A beam that meets n unknown voxels has n + 1 outcomes of the same probability:
//! reflected in one of them, or through all of them.

use crate::octree::key::VoxelKey;
use crate::octree::map::OccupancyMap;
use crate::octree::ray::Cursor;
use crate::octree::sensor_model::{SensorModel, UNKNOWN};
use crate::octree::traversal::{Traversal, norm};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// What beams are expected to do to one voxel.
#[derive(Clone, Copy, Debug, Default)]
struct Expected {
    passed: f64,
    reflected: f64,
}

/// Voxels that count: `low <= key <= high` on each axis.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    /// Lowest voxel.
    pub low: VoxelKey,
    /// Highest voxel.
    pub high: VoxelKey,
}

impl Region {
    /// Whether a voxel counts.
    #[inline]
    #[must_use]
    pub fn holds(&self, voxel: VoxelKey) -> bool {
        (0..3).all(|axis| (self.low.0[axis]..=self.high.0[axis]).contains(&voxel.0[axis]))
    }
}

impl OccupancyMap {
    /// Expected reduction of entropy [nat] by a measurement from each origin with its share of the directions.
    ///
    /// `directions` holds as many rays for each origin, one origin after the other. Without a `region` all
    /// unknown voxels count.
    #[must_use]
    pub fn information_gain(
        &self,
        origins_m: &[[f32; 3]],
        directions: &[[f32; 3]],
        max_range_m: f64,
        region: Option<Region>,
        threads: usize,
    ) -> Vec<f64> {
        if origins_m.is_empty() {
            return Vec::new();
        }
        let rays = directions.len() / origins_m.len();
        let gain = |(number, &origin_m): (usize, &[f32; 3])| {
            let mine = &directions[number * rays..(number + 1) * rays];
            self.gain_of(origin_m, mine, max_range_m, region)
        };
        if threads <= 1 {
            origins_m.iter().enumerate().map(gain).collect()
        } else {
            origins_m.par_iter().enumerate().map(gain).collect()
        }
    }

    fn gain_of(
        &self,
        origin_m: [f32; 3],
        directions: &[[f32; 3]],
        max_range_m: f64,
        region: Option<Region>,
    ) -> f64 {
        let Some(start) = self.lattice.voxel(origin_m) else {
            return 0.0;
        };
        let mut seen: FxHashMap<VoxelKey, Expected> = FxHashMap::default();
        let mut unknown: Vec<VoxelKey> = Vec::new();
        let mut cursor = Cursor::new(self, start);
        for &direction in directions {
            let length = norm(direction);
            if !(length > 0.0 && length.is_finite()) {
                continue;
            }
            let mut ray = Traversal::new(
                &self.lattice,
                start,
                origin_m,
                direction.map(|d| d / length),
            );
            unknown.clear();
            loop {
                match cursor.value(ray.voxel) {
                    UNKNOWN => unknown.push(ray.voxel),
                    value if value >= 0 => break,
                    _ => {}
                }
                if ray.exit_m() > max_range_m || !ray.voxel.within_reach() {
                    break;
                }
                ray.advance();
            }
            let outcomes = unknown.len() as f64 + 1.0;
            for (number, &voxel) in unknown.iter().enumerate() {
                if region.is_none_or(|region| region.holds(voxel)) {
                    let expected = seen.entry(voxel).or_default();
                    let passed = 1.0 - (number as f64 + 1.0) / outcomes;
                    expected.passed = expected.passed.max(passed);
                    expected.reflected = expected.reflected.max(1.0 / outcomes);
                }
            }
        }
        let (by_miss, by_hit) = reductions(&self.model);
        // Keys are summed in a fixed order so that the same map gives the same sum to the last bit.
        let mut gains: Vec<(VoxelKey, f64)> = seen
            .into_iter()
            .map(|(key, e)| (key, e.passed * by_miss + e.reflected * by_hit))
            .collect();
        gains.sort_unstable_by_key(|&(key, _)| key);
        gains.into_iter().map(|(_, gain)| gain).sum()
    }
}

/// Entropy [nat] that an unknown voxel loses by a first miss and by a first hit.
#[must_use]
pub fn reductions(model: &SensorModel) -> (f64, f64) {
    let of = |log_odds: f64| std::f64::consts::LN_2 - entropy(log_odds);
    (
        of(model.log_odds(model.miss)),
        of(model.log_odds(model.hit)),
    )
}

/// Entropy of a voxel [nat] (Wurm, eq. 5.27).
#[must_use]
pub fn entropy(log_odds: f64) -> f64 {
    let p = 1.0 / (1.0 + (-log_odds).exp());
    -p * p.ln() - (1.0 - p) * (1.0 - p).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octree::sensor_model::SensorModel;

    fn corridor() -> OccupancyMap {
        // Along x: voxel 0 free, 1 and 2 unknown, 3 occupied.
        let mut map = OccupancyMap::new(1.0, SensorModel::thesis());
        map.occupancy.set(VoxelKey([0, 0, 0]), -8);
        map.occupancy.set(VoxelKey([3, 0, 0]), 17);
        map
    }

    #[test]
    fn two_unknown_voxels_before_a_wall_have_three_outcomes() {
        let map = corridor();
        let (miss, hit) = reductions(&map.model);
        let gain = map.information_gain(&[[0.5; 3]], &[[1.0, 0.0, 0.0]], 10.0, None, 1);
        let expected = (2.0 / 3.0 * miss + hit / 3.0) + (1.0 / 3.0 * miss + hit / 3.0);
        assert!((gain[0] - expected).abs() < 1e-12, "{gain:?} {expected}");
        // The same beam twice sees nothing more; a region leaves voxels out.
        let twice = map.information_gain(
            &[[0.5; 3]],
            &[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]],
            10.0,
            None,
            2,
        );
        assert!((twice[0] - expected).abs() < 1e-12);
        let region = Region {
            low: VoxelKey([2, 0, 0]),
            high: VoxelKey([9, 0, 0]),
        };
        let part = map.information_gain(&[[0.5; 3]], &[[1.0, 0.0, 0.0]], 10.0, Some(region), 1);
        assert!((part[0] - (miss + hit) / 3.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_known_brings_nothing() {
        let mut map = corridor();
        map.occupancy.set(VoxelKey([1, 0, 0]), -8);
        map.occupancy.set(VoxelKey([2, 0, 0]), -8);
        let gain = map.information_gain(&[[0.5; 3]], &[[1.0, 0.0, 0.0]], 10.0, None, 1);
        assert_eq!(gain, [0.0]);
    }

    #[test]
    fn the_constants_have_the_entropies_of_their_probabilities() {
        assert!((entropy(0.0) - std::f64::consts::LN_2).abs() < 1e-12);
        let (miss, hit) = reductions(&SensorModel::thesis());
        assert!(
            (miss - 0.0196).abs() < 1e-3 && (hit - 0.0824).abs() < 2e-3,
            "{miss} {hit}"
        );
    }
}
