//! Voxel and brick coordinates.

/// Voxels along one edge of a brick.
pub const EDGE: i32 = 8;
/// Voxels in a brick.
pub const VOXELS: usize = 512;
/// Voxel indices lie in `-LIMIT..LIMIT` on each axis.
pub const LIMIT: i32 = 1 << 23;

/// Integer voxel coordinates: voxel `(0, 0, 0)` has its lowest corner at the map's origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct VoxelKey(pub [i32; 3]);

/// A brick's coordinates (voxel coordinates divided by eight), packed into 63 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BrickKey(pub u64);

const AXIS_BITS: u32 = 21;
const OFFSET: i32 = 1 << (AXIS_BITS - 1);

/// Three bits spread to every third place: the part of one axis in a Morton index.
const SPREAD: [u16; 8] = [0, 1, 8, 9, 64, 65, 72, 73];

impl VoxelKey {
    /// The brick that holds the voxel.
    #[inline]
    #[must_use]
    pub fn brick(self) -> BrickKey {
        BrickKey::new(self.0.map(|k| k >> 3))
    }

    /// Whether the voxel and its neighbours have keys.
    #[inline]
    #[must_use]
    pub fn within_reach(self) -> bool {
        self.0.iter().all(|k| (-LIMIT + 1..LIMIT - 1).contains(k))
    }

    /// Position within its brick, in Morton order (x is the lowest bit).
    #[inline]
    #[must_use]
    pub fn offset(self) -> usize {
        let [x, y, z] = self.0.map(|k| SPREAD[(k & 7) as usize] as usize);
        x | y << 1 | z << 2
    }
}

impl BrickKey {
    /// From brick coordinates.
    #[inline]
    #[must_use]
    pub fn new(coordinates: [i32; 3]) -> Self {
        let [x, y, z] = coordinates.map(|k| (k + OFFSET) as u64);
        Self(x | y << AXIS_BITS | z << (2 * AXIS_BITS))
    }

    /// Brick coordinates.
    #[inline]
    #[must_use]
    pub fn coordinates(self) -> [i32; 3] {
        let axis = |shift: u32| ((self.0 >> shift) & ((1 << AXIS_BITS) - 1)) as i32 - OFFSET;
        [axis(0), axis(AXIS_BITS), axis(2 * AXIS_BITS)]
    }

    /// The voxel at a Morton position of this brick.
    #[must_use]
    pub fn voxel(self, offset: usize) -> VoxelKey {
        let low = |axis: usize| {
            let bits = offset >> axis;
            (bits & 1 | bits >> 2 & 2 | bits >> 4 & 4) as i32
        };
        let [x, y, z] = self.coordinates();
        VoxelKey([x * EDGE + low(0), y * EDGE + low(1), z * EDGE + low(2)])
    }
}

/// Between metres in the map frame and voxels.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    /// Edge of a voxel [m].
    pub resolution_m: f64,
    per_metre: f64,
}

impl Lattice {
    /// A lattice of voxels with edges of `resolution_m`.
    #[must_use]
    pub fn new(resolution_m: f64) -> Self {
        Self {
            resolution_m,
            per_metre: 1.0 / resolution_m,
        }
    }

    /// The voxel that holds a point; `None` beyond the largest key or for a coordinate that is not finite.
    #[inline]
    #[must_use]
    pub fn voxel(&self, point_m: [f32; 3]) -> Option<VoxelKey> {
        let mut key = [0; 3];
        for (k, &coordinate) in key.iter_mut().zip(&point_m) {
            let scaled = (self.per_metre * f64::from(coordinate)).floor();
            if !(scaled >= f64::from(-LIMIT) && scaled < f64::from(LIMIT)) {
                return None;
            }
            *k = scaled as i32;
        }
        Some(VoxelKey(key))
    }

    /// Centre of a voxel along one axis [m].
    #[inline]
    #[must_use]
    pub fn centre_m(&self, index: i32) -> f64 {
        (f64::from(index) + 0.5) * self.resolution_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_voxel_is_found_again_from_its_brick_and_offset(
            x in -LIMIT..LIMIT, y in -LIMIT..LIMIT, z in -LIMIT..LIMIT
        ) {
            let voxel = VoxelKey([x, y, z]);
            prop_assert_eq!(voxel.brick().voxel(voxel.offset()), voxel);
        }
    }

    #[test]
    fn offsets_follow_the_octree() {
        // x is bit 0, y bit 1, z bit 2 of a child's number; the coarser levels come first.
        assert_eq!(VoxelKey([1, 0, 0]).offset(), 1);
        assert_eq!(VoxelKey([0, 0, 1]).offset(), 4);
        assert_eq!(VoxelKey([4, 4, 4]).offset(), 7 << 6);
    }

    #[test]
    fn points_out_of_reach_have_no_voxel() {
        let lattice = Lattice::new(0.1);
        assert_eq!(
            lattice.voxel([0.05, -0.05, 0.0]),
            Some(VoxelKey([0, -1, 0]))
        );
        assert_eq!(lattice.voxel([f32::NAN, 0.0, 0.0]), None);
        assert_eq!(lattice.voxel([1e9, 0.0, 0.0]), None);
    }
}
