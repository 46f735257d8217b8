//! Occupancy mapping from laser scans: log odds on a grid that all robots share.
//!
//! Moravec and Elfes, "High Resolution Maps from Wide Angle Sonar", ICRA 1985; in log odds as in
//! Thrun, Burgard and Fox, Probabilistic Robotics (2005), table 9.1. A cell is updated at most once
//! a scan, and an end point outweighs the beams that pass it.

use std::f64::consts::TAU;

use crate::floor::Point;

/// Sensor model in log odds.
#[derive(Clone, Copy)]
pub struct SensorModel {
    /// Added where a beam ends.
    pub hit: f32,
    /// Added where a beam passes; negative.
    pub miss: f32,
    /// Bounds of a cell's value, so that the map can change its mind.
    pub limit: f32,
}

/// Log odds of occupation; zero where nothing was ever seen.
#[derive(Clone)]
pub struct OccupancyMap {
    width: usize,
    height: usize,
    resolution_m: f64,
    origin_m: Point,
    model: SensorModel,
    log_odds: Vec<f32>,
    seen: Vec<u64>,
    scans: u64,
}

impl OccupancyMap {
    /// An empty map.
    pub fn new(
        width: usize,
        height: usize,
        resolution_m: f64,
        origin_m: Point,
        model: SensorModel,
    ) -> Self {
        Self {
            width,
            height,
            resolution_m,
            origin_m,
            model,
            log_odds: vec![0.0; width * height],
            seen: vec![0; width * height],
            scans: 0,
        }
    }

    /// All cells' log odds, row-major.
    pub fn log_odds(&self) -> &[f32] {
        &self.log_odds
    }

    /// Occupancy in percent, -1 where nothing was ever seen.
    pub fn percent(&self) -> Vec<i8> {
        let percent = |&value: &f32| match value {
            0.0 => -1,
            value => (100.0 / (1.0 + (-value).exp())).round() as i8,
        };
        self.log_odds.iter().map(percent).collect()
    }

    /// Takes a full-circle scan in; a beam as long as `range_m` met nothing, one that is not a number
    /// was not made.
    pub fn insert(&mut self, origin: Point, heading_rad: f64, ranges_m: &[f32], range_m: f64) {
        let step_rad = TAU / ranges_m.len() as f64;
        self.insert_fan(origin, heading_rad, step_rad, ranges_m, range_m);
    }

    /// Takes a fan of beams in, counter-clockwise from `first_rad` in the map frame; a beam of no
    /// length says nothing.
    pub fn insert_fan(
        &mut self,
        origin: Point,
        first_rad: f64,
        step_rad: f64,
        ranges_m: &[f32],
        range_m: f64,
    ) {
        // Two stamps a scan: passed (even) and hit (odd), so that hits are final.
        self.scans += 1;
        let (passed, hit) = (2 * self.scans, 2 * self.scans + 1);
        let direction = |beam: usize| {
            let (sine, cosine) = (first_rad + step_rad * beam as f64).sin_cos();
            [cosine, sine]
        };
        // A hair further, so that an end point on a cell's border falls into the cell that was hit.
        let beyond = 1e-3 * self.resolution_m;
        for (beam, &range) in ranges_m.iter().enumerate() {
            if range > 0.0 && f64::from(range) < range_m {
                let along = direction(beam);
                let reach = f64::from(range) + beyond;
                let end = [origin[0] + reach * along[0], origin[1] + reach * along[1]];
                if let Some(cell) = self.cell(end) {
                    self.update(cell, hit, self.model.hit);
                }
            }
        }
        for (beam, &range) in ranges_m.iter().enumerate() {
            self.pass(origin, direction(beam), f64::from(range), passed);
        }
    }

    /// Takes over from another map of the same shape whatever is more certain there.
    ///
    /// Merging the same map twice changes nothing, as it must when robots meet again and again.
    pub fn merge(&mut self, other: &Self) {
        for (mine, theirs) in self.log_odds.iter_mut().zip(&other.log_odds) {
            if theirs.abs() > mine.abs() {
                *mine = *theirs;
            }
        }
    }

    /// Column and row of a position, or None outside.
    fn place(&self, [x, y]: Point) -> Option<[usize; 2]> {
        let column = (x - self.origin_m[0]) / self.resolution_m;
        let row = (y - self.origin_m[1]) / self.resolution_m;
        let inside =
            column >= 0.0 && row >= 0.0 && column < self.width as f64 && row < self.height as f64;
        inside.then_some([column as usize, row as usize])
    }

    fn cell(&self, at: Point) -> Option<usize> {
        let [column, row] = self.place(at)?;
        Some(row * self.width + column)
    }

    fn update(&mut self, cell: usize, stamp: u64, change: f32) {
        // A cell that was hit in this scan carries the larger stamp already.
        if self.seen[cell] < stamp {
            self.seen[cell] = stamp;
            let limit = self.model.limit;
            self.log_odds[cell] = (self.log_odds[cell] + change).clamp(-limit, limit);
        }
    }

    /// Marks the cells that a beam passes before its end.
    fn pass(&mut self, origin: Point, direction: Point, range: f64, stamp: u64) {
        let nudge = 1e-7 * self.resolution_m;
        let mut travelled = 0.0;
        while travelled < range {
            let at = [
                origin[0] + travelled * direction[0],
                origin[1] + travelled * direction[1],
            ];
            let Some(place) = self.place(at) else { return };
            self.update(place[1] * self.width + place[0], stamp, self.model.miss);
            let leave = |axis: usize| {
                let next = place[axis] + usize::from(direction[axis] > 0.0);
                let border = self.origin_m[axis] + next as f64 * self.resolution_m;
                if direction[axis].abs() < 1e-12 {
                    f64::INFINITY
                } else {
                    ((border - at[axis]) / direction[axis]).max(0.0)
                }
            };
            travelled += leave(0).min(leave(1)) + nudge;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::tests::drawn;
    use crate::raycast::{Obstacles, scan};

    const MODEL: SensorModel = SensorModel {
        hit: 0.85,
        miss: -0.4,
        limit: 4.0,
    };

    #[test]
    fn a_room_is_mapped_free_inside_occupied_around_and_unknown_beyond() {
        let floor = drawn(
            &[
                "..........",
                ".########.",
                ".#......#.",
                ".#......#.",
                ".#......#.",
                ".########.",
                "..........",
            ],
            0.5,
        );
        let origin = [2.55, 1.77];
        let mut map = OccupancyMap::new(10, 7, 0.5, [0.0, 0.0], MODEL);
        let (mut ranges, mut hits) = (vec![0.0; 360], vec![0; 360]);
        let none = Obstacles {
            segments: &[],
            discs: &[],
        };
        scan(&floor, &none, origin, 0.3, 8.0, &mut ranges, &mut hits);
        for _ in 0..3 {
            map.insert(origin, 0.3, &ranges, 8.0);
        }
        let value = |column: usize, row: usize| map.log_odds()[row * 10 + column];
        for column in 2..8 {
            for row in 2..5 {
                assert!((value(column, row) + 1.2).abs() < 1e-5, "{column} {row}");
            }
            assert!(value(column, 1) > 2.0 && value(column, 5) > 2.0);
            assert_eq!((value(column, 0), value(column, 6)), (0.0, 0.0));
        }
    }

    #[test]
    fn a_merged_map_knows_what_either_knew() {
        let mut one = OccupancyMap::new(9, 9, 0.5, [0.0, 0.0], MODEL);
        let mut other = OccupancyMap::new(9, 9, 0.5, [0.0, 0.0], MODEL);
        one.insert([1.2, 1.2], 0.0, &[0.6; 8], 5.0);
        other.insert([3.2, 3.2], 0.0, &[0.6; 8], 5.0);
        let (before, theirs) = (one.log_odds.clone(), other.log_odds.clone());
        one.merge(&other);
        for cell in 0..81 {
            let expected = if theirs[cell].abs() > before[cell].abs() {
                theirs[cell]
            } else {
                before[cell]
            };
            assert_eq!(one.log_odds[cell], expected);
        }
        let merged = one.log_odds.clone();
        one.merge(&other);
        assert_eq!(one.log_odds, merged);
    }

    #[test]
    fn beams_that_are_not_numbers_are_left_out() {
        let mut map = OccupancyMap::new(9, 9, 0.5, [0.0, 0.0], MODEL);
        map.insert([2.2, 2.2], 0.0, &[f32::NAN; 8], 5.0);
        assert!(map.log_odds().iter().all(|&value| value == 0.0));
    }

    #[test]
    fn values_stay_within_their_limit() {
        let mut map = OccupancyMap::new(9, 9, 0.5, [0.0, 0.0], MODEL);
        for _ in 0..100 {
            map.insert([2.2, 2.2], 0.0, &[1.0; 8], 5.0);
        }
        assert!(map.log_odds().iter().all(|value| value.abs() <= 4.0));
    }
}
