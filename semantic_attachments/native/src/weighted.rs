//! Distances from one cell to all others where cells cost differently: Dijkstra's algorithm with buckets.
//!
//! A step on to a cell that the one before could have reached as cheaply is not tried: since no multiplier is negative, the
//! three cells beside and behind the last step are such. Complexity: `O(cells + longest distance)`.

use crate::buckets::Buckets;
use crate::shape::{STEP_LENGTHS, STEPS, Shape};

/// A cell; all that a step needs to know is in one place of the memory.
#[derive(Clone, Copy)]
struct Record {
    length: f64,
    factor: f32,
    moves: u8,
    /// Steps that are worth trying from here.
    onward: u8,
}

/// Half the length of each step: it counts for both of its cells.
const HALF_STEPS: [f64; 8] = {
    let mut halves = STEP_LENGTHS;
    let mut step = 0;
    while step < 8 {
        halves[step] *= 0.5;
        step += 1;
    }
    halves
};

/// Length of a step between cells of two multipliers, in cells times multiplier.
#[must_use]
#[inline]
pub fn step_length(step: usize, from: f32, to: f32) -> f64 {
    HALF_STEPS[step] * (f64::from(from) + f64::from(to))
}

/// Length of the shortest path from `source` to each cell, in cells times multiplier; multipliers are at least 1.
#[must_use]
pub fn weighted_lengths(
    shape: Shape,
    moves: &[u8],
    source: u32,
    factors: Option<&[f32]>,
) -> Vec<f64> {
    let largest = factors.map_or(1.0, |f| f64::from(f.iter().copied().fold(1.0, f32::max)));
    let offsets = shape.offsets();
    let onward = onward_steps();
    let mut records: Vec<Record> = moves
        .iter()
        .enumerate()
        .map(|(cell, &moves)| Record {
            length: f64::INFINITY,
            factor: factors.map_or(1.0, |factors| factors[cell]),
            moves,
            onward: u8::MAX,
        })
        .collect();
    records[source as usize].length = 0.0;
    // No edge is shorter than 1.
    let mut buckets = Buckets::new((largest * std::f64::consts::SQRT_2).ceil() as usize + 2);
    buckets.push(0, source);
    while let Some((number, cells)) = buckets.pop() {
        for &cell in &cells {
            let from = records[cell as usize];
            if bucket(from.length) != number {
                continue; // a shorter path settled it in an earlier bucket
            }
            // A cell that is twice in the bucket is settled once.
            records[cell as usize].onward = 0;
            let mut open = from.moves & from.onward;
            while open != 0 {
                let step = open.trailing_zeros() as usize;
                open &= open - 1;
                let next = (cell as isize + offsets[step]) as u32;
                let to = &mut records[next as usize];
                let reached = from.length + step_length(step, from.factor, to.factor);
                if reached < to.length {
                    to.length = reached;
                    to.onward = onward[step];
                    buckets.push(bucket(reached), next);
                }
            }
        }
        buckets.give_back(cells);
    }
    records.iter().map(|record| record.length).collect()
}

/// The bucket of a length: the nearest integer, by the bits that are left of it beside the largest number with a fraction.
///
/// A bucket is a little narrower than a step is short, lest two ends of a step halfway between integers share one.
#[inline]
fn bucket(length: f64) -> u64 {
    const LARGEST: f64 = (1_u64 << 52) as f64;
    (length * 1.000_001 + LARGEST).to_bits() & ((1 << 52) - 1)
}

/// Steps worth trying after each step.
fn onward_steps() -> [u8; 8] {
    let mut onward = [0; 8];
    for (last, &(up, right)) in STEPS.iter().enumerate() {
        for (step, &(rows, columns)) in STEPS.iter().enumerate() {
            // Back beside the cell before: at most one step from it, and a straight one if it is beside.
            let beside = (up + rows, right + columns);
            let is_near = beside.0.abs() + beside.1.abs() <= 1;
            onward[last] |= u8::from(!is_near) << step;
        }
    }
    onward
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_never_stays_in_its_bucket() {
        for (length, expected) in [(0.0, 0), (0.4, 0), (0.6, 1), (7.0, 7), (1e5, 100_000)] {
            assert_eq!(bucket(length), expected);
        }
        for halves in 0..10_000 {
            let length = 0.5 * f64::from(halves);
            assert!(bucket(length + 1.0) > bucket(length));
        }
    }

    #[test]
    fn five_steps_of_eight_go_on() {
        // East: not west, north-west, south-west. North-east: not south-west, west, south.
        let onward = onward_steps();
        assert_eq!(onward[0], 0b1001_1011);
        assert_eq!(onward[4], 0b1011_0011);
        assert!(onward.iter().all(|steps| steps.count_ones() == 5));
    }
}
