//! Voxels along a ray.
//!
//! Source: Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing", Eurographics 1987. Directions are
//! single precision and distances double precision, as in OctoMap, so that both visit the same voxels.

use crate::octree::key::{Lattice, VoxelKey};

/// Walks from voxel to voxel.
#[derive(Clone, Debug)]
pub struct Traversal {
    /// The current voxel.
    pub voxel: VoxelKey,
    step: [i32; 3],
    next_border_m: [f64; 3],
    border_spacing_m: [f64; 3],
}

impl Traversal {
    /// Starts in the voxel of `origin_m`, along the unit vector `direction`.
    #[must_use]
    pub fn new(
        lattice: &Lattice,
        voxel: VoxelKey,
        origin_m: [f32; 3],
        direction: [f32; 3],
    ) -> Self {
        let mut traversal = Self {
            voxel,
            step: [0; 3],
            next_border_m: [f64::MAX; 3],
            border_spacing_m: [f64::MAX; 3],
        };
        for axis in 0..3 {
            let slope = f64::from(direction[axis]);
            if slope == 0.0 {
                continue;
            }
            let step = if slope > 0.0 { 1 } else { -1 };
            let half = f64::from((f64::from(step) * lattice.resolution_m * 0.5) as f32);
            let border = lattice.centre_m(voxel.0[axis]) + half;
            traversal.step[axis] = step;
            traversal.next_border_m[axis] = (border - f64::from(origin_m[axis])) / slope;
            traversal.border_spacing_m[axis] = lattice.resolution_m / slope.abs();
        }
        traversal
    }

    /// Moves to the next voxel.
    #[inline]
    pub fn advance(&mut self) {
        let [x, y, z] = self.next_border_m;
        // Ties go to the later axis, as in OctoMap. All three axes are written, with masks in place of branches that
        // no processor could foresee and of indices that would keep the state out of registers.
        let along_x = (x < y) & (x < z);
        let along_y = !along_x & (y < z);
        for (axis, along) in [along_x, along_y, !(along_x | along_y)]
            .into_iter()
            .enumerate()
        {
            self.voxel.0[axis] += self.step[axis] & -i32::from(along);
            let spacing_m =
                self.border_spacing_m[axis].to_bits() & (u64::from(along)).wrapping_neg();
            self.next_border_m[axis] += f64::from_bits(spacing_m);
        }
    }

    /// Length of the ray up to where it leaves the current voxel [m].
    #[inline]
    #[must_use]
    pub fn exit_m(&self) -> f64 {
        let [x, y, z] = self.next_border_m;
        x.min(y).min(z)
    }
}

/// Length in single precision, rounded the way OctoMap does (squares summed in single, root in double precision).
#[must_use]
pub fn norm(vector: [f32; 3]) -> f32 {
    let [x, y, z] = vector;
    f64::from(x * x + y * y + z * z).sqrt() as f32
}

/// Calls `visit` with every voxel from the origin's up to, not including, the end point's; `false` if either lies out of reach.
#[inline]
pub fn walk(
    lattice: &Lattice,
    origin_m: [f32; 3],
    end_m: [f32; 3],
    mut visit: impl FnMut(VoxelKey),
) -> bool {
    let (Some(first), Some(last)) = (lattice.voxel(origin_m), lattice.voxel(end_m)) else {
        return false;
    };
    if first == last {
        return true;
    }
    let difference: [f32; 3] = std::array::from_fn(|axis| end_m[axis] - origin_m[axis]);
    let length_m = norm(difference);
    let mut traversal = Traversal::new(lattice, first, origin_m, difference.map(|d| d / length_m));
    visit(first);
    let length_m = f64::from(length_m);
    loop {
        traversal.advance();
        let [x, y, z] = traversal.voxel.0;
        let left = (x ^ last.0[0]) | (y ^ last.0[1]) | (z ^ last.0[2]);
        // The second test catches a ray that rounding led past its last voxel.
        if (left == 0) | (traversal.exit_m() > length_m) {
            return true;
        }
        visit(traversal.voxel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn voxels(origin: [f32; 3], end: [f32; 3]) -> Vec<[i32; 3]> {
        let mut seen = Vec::new();
        assert!(walk(&Lattice::new(1.0), origin, end, |voxel| seen.push(voxel.0)));
        seen
    }

    #[test]
    fn a_ray_along_an_axis_visits_the_voxels_before_its_end() {
        assert_eq!(
            voxels([0.5, 0.5, 0.5], [3.5, 0.5, 0.5]),
            [[0, 0, 0], [1, 0, 0], [2, 0, 0]]
        );
        assert_eq!(voxels([0.5, 0.5, 0.5], [0.6, 0.5, 0.5]), [[0; 3]; 0]);
    }

    proptest! {
        #[test]
        fn neighbours_share_a_face(
            origin in prop::array::uniform3(-20.0f32..20.0), end in prop::array::uniform3(-20.0f32..20.0)
        ) {
            for pair in voxels(origin, end).windows(2) {
                let steps: i32 = (0..3).map(|axis| (pair[0][axis] - pair[1][axis]).abs()).sum();
                prop_assert_eq!(steps, 1);
            }
        }
    }
}
