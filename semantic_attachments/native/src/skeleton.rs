//! Skeleton of a region along the ridges of its distance map: a discrete Voronoi graph.
//!
//! Distance-ordered homotopic thinning (Pudney, "Distance-Ordered Homotopic Thinning", Computer
//! Vision and Image Understanding 72, 1998): cells are taken away from the obstacles inwards, each
//! only if that changes neither the number of parts nor of holes. Anchors, which end branches, are
//! cells where two neighbours' nearest obstacles lie far apart (Hesselink and Roerdink, "Euclidean
//! Skeletons of Digital Image and Volume Data in Linear Time by the Integer Medial Axis Transform",
//! IEEE PAMI 30, 2008). Linear in the cells.

use crate::distance_transform::{DistanceTransform, NO_OBSTACLE};
use crate::shape::Shape;

/// Which branches of a skeleton are worth keeping.
#[derive(Clone, Copy, Debug)]
pub struct Pruning {
    /// Least distance between the two obstacles that a branch runs between [cells].
    pub least_chord_cells: f64,
    /// The same relative to their distance from the branch: 2 for parallel walls, 1.41 in a right
    /// angle.
    pub least_chord_ratio: f64,
}

/// The eight neighbours in cyclic order, so that each shares an edge or a corner with the next.
fn ring(stride: isize) -> [isize; 8] {
    [
        1,
        stride + 1,
        stride,
        stride - 1,
        -1,
        -stride - 1,
        -stride,
        1 - stride,
    ]
}

/// Marks a skeleton of `region`, one cell wide, with the region's parts and holes (8-connected).
#[must_use]
pub fn skeleton(
    shape: Shape,
    region: &[bool],
    distances: &DistanceTransform,
    pruning: Pruning,
) -> Vec<bool> {
    let (height, width) = (shape.height, shape.width);
    let stride = width + 2;
    let padded = |cell: usize| (cell / width + 1) * stride + cell % width + 1;
    let mut inside = vec![0u8; (height + 2) * stride];
    let mut squared = vec![0u32; inside.len()];
    for (cell, &is_inside) in region.iter().enumerate() {
        inside[padded(cell)] = u8::from(is_inside);
        squared[padded(cell)] = distances.squared[cell];
    }
    let mut is_anchor = vec![false; inside.len()];
    for cell in anchors(shape, region, distances, pruning) {
        is_anchor[padded(cell)] = true;
    }
    let order = by_distance(&inside, &squared);
    let mut thinning = Thinning {
        inside,
        ring: ring(stride as isize),
    };
    thinning.take_away(&order, &squared, |at, _| !is_anchor[at]);
    // Anchors may lie two abreast; what ends a branch stays.
    thinning.take_away(&order, &squared, |_, neighbours| neighbours >= 2);
    (0..shape.len())
        .map(|cell| thinning.inside[padded(cell)] == 1)
        .collect()
}

/// Cells from which two obstacles far apart are equally near, but for the width of a cell.
fn anchors(
    shape: Shape,
    region: &[bool],
    distances: &DistanceTransform,
    pruning: Pruning,
) -> Vec<usize> {
    let width = shape.width;
    let mut found = Vec::new();
    let mut compare = |one: usize, other: usize| {
        if !(region[one] && region[other]) {
            return;
        }
        let (a, b) = (distances.nearest[one], distances.nearest[other]);
        let ((ar, ac), (br, bc)) = (shape.row_column(a), shape.row_column(b));
        let chord2 = ((ar - br).pow(2) + (ac - bc).pow(2)) as f64;
        let nearer2 = distances.squared[one].min(distances.squared[other]);
        if nearer2 == NO_OBSTACLE || chord2 <= pruning.least_chord_cells.powi(2) {
            return;
        }
        if chord2 > pruning.least_chord_ratio.powi(2) * f64::from(nearer2) {
            found.push(if distances.squared[one] >= distances.squared[other] {
                one
            } else {
                other
            });
        }
    };
    for cell in 0..shape.len() {
        if cell % width + 1 < width {
            compare(cell, cell + 1);
        }
        if cell + width < shape.len() {
            compare(cell, cell + width);
        }
    }
    found
}

/// The cells inside, nearest to an obstacle first, by counting.
fn by_distance(inside: &[u8], squared: &[u32]) -> Vec<usize> {
    let cells = || (0..inside.len()).filter(|&at| inside[at] == 1);
    // A tenth of a cell is fine enough an order.
    let bucket = |at: usize| (f64::from(squared[at]).sqrt() * 10.0) as usize;
    let most = cells()
        .filter(|&at| squared[at] != NO_OBSTACLE)
        .map(bucket)
        .max()
        .unwrap_or(0)
        + 1;
    let mut starts = vec![0usize; most + 2];
    for at in cells() {
        starts[bucket(at).min(most) + 1] += 1;
    }
    for index in 1..starts.len() {
        starts[index] += starts[index - 1];
    }
    let mut order = vec![0; starts[most + 1]];
    for at in cells() {
        let slot = &mut starts[bucket(at).min(most)];
        order[*slot] = at;
        *slot += 1;
    }
    order
}

struct Thinning {
    inside: Vec<u8>,
    ring: [isize; 8],
}

impl Thinning {
    /// Takes cells away in order; one that stays is looked at again when a neighbour goes.
    fn take_away(&mut self, order: &[usize], squared: &[u32], may_go: impl Fn(usize, u32) -> bool) {
        let mut again: Vec<usize> = Vec::new();
        for &first in order {
            again.push(first);
            while let Some(at) = again.pop() {
                if self.inside[at] == 0 {
                    continue;
                }
                let bits = self.neighbours(at);
                if !is_simple(bits) || !may_go(at, bits.count_ones()) {
                    continue;
                }
                self.inside[at] = 0;
                for step in self.ring {
                    let next = at.wrapping_add_signed(step);
                    if self.inside[next] == 1 && squared[next] <= squared[first] {
                        again.push(next);
                    }
                }
            }
        }
    }

    fn neighbours(&self, at: usize) -> u8 {
        self.ring.iter().enumerate().fold(0, |bits, (k, &step)| {
            bits | self.inside[at.wrapping_add_signed(step)] << k
        })
    }
}

/// Whether a cell with these neighbours can go and leave parts and holes as they are: Yokoi's
/// connectivity number for 8-connected regions is one.
const fn is_simple(bits: u8) -> bool {
    let mut number = 0;
    let mut k = 0;
    while k < 8 {
        let a = 1 - ((bits >> k) & 1);
        let b = 1 - ((bits >> ((k + 1) % 8)) & 1);
        let c = 1 - ((bits >> ((k + 2) % 8)) & 1);
        number += a - a * b * c;
        k += 2;
    }
    number == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance_transform::distance_transform;
    use proptest::prelude::*;

    const PRUNING: Pruning = Pruning {
        least_chord_cells: 2.5,
        least_chord_ratio: 1.2,
    };

    fn skeleton_of(rows: &[&str]) -> Vec<String> {
        let shape = Shape {
            height: rows.len(),
            width: rows[0].len(),
        };
        let region: Vec<bool> = rows.concat().bytes().map(|byte| byte == b'.').collect();
        let obstacle: Vec<bool> = region.iter().map(|&free| !free).collect();
        let found = skeleton(
            shape,
            &region,
            &distance_transform(shape, &obstacle),
            PRUNING,
        );
        found
            .chunks(shape.width)
            .map(|row| {
                row.iter()
                    .map(|&kept| if kept { '*' } else { ' ' })
                    .collect()
            })
            .collect()
    }

    #[test]
    fn a_corridor_has_its_middle_line() {
        let found = skeleton_of(&[
            "#############",
            "#...........#",
            "#...........#",
            "#...........#",
            "#############",
        ]);
        assert_eq!(&found[2][3..10], "*******");
        assert!(!found[1][4..9].contains('*') && !found[3][4..9].contains('*'));
    }

    /// Numbers of 8-connected parts inside and 4-connected parts outside.
    fn topology(shape: Shape, region: &[bool]) -> (usize, usize) {
        let padded = Shape {
            height: shape.height + 2,
            width: shape.width + 2,
        };
        let mut cells = vec![false; padded.len()];
        for (cell, &is_inside) in region.iter().enumerate() {
            cells[(cell / shape.width + 1) * padded.width + cell % shape.width + 1] = is_inside;
        }
        let parts = |value: bool, steps: usize| {
            let mut seen = vec![false; padded.len()];
            let mut count = 0;
            for start in 0..padded.len() as u32 {
                if seen[start as usize] || cells[start as usize] != value {
                    continue;
                }
                count += 1;
                let mut stack = vec![start];
                seen[start as usize] = true;
                while let Some(cell) = stack.pop() {
                    for next in (0..steps).filter_map(|step| padded.neighbour(cell, step)) {
                        if !seen[next as usize] && cells[next as usize] == value {
                            seen[next as usize] = true;
                            stack.push(next);
                        }
                    }
                }
            }
            count
        };
        (parts(true, 8), parts(false, 4))
    }

    proptest! {
        #[test]
        fn parts_and_holes_stay(
            width in 1usize..24, height in 1usize..24, bits in proptest::collection::vec(0u8..5, 576),
        ) {
            let shape = Shape { height, width };
            let region: Vec<bool> = bits[..shape.len()].iter().map(|&bit| bit != 0).collect();
            let obstacle: Vec<bool> = region.iter().map(|&free| !free).collect();
            let found = skeleton(shape, &region, &distance_transform(shape, &obstacle), PRUNING);
            prop_assert!(found.iter().zip(&region).all(|(&kept, &free)| free || !kept));
            prop_assert_eq!(topology(shape, &found), topology(shape, &region));
        }
    }
}
