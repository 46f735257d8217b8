//! Distances from one cell to all others where all cells cost the same.
//!
//! Many shortest paths differ only in the order of their steps. Only those that take diagonal steps first are followed,
//! and others where an obstacle leaves no such path. On them nearly all cells are passed straight ahead, which needs no queue:
//! a run is written at once, up to a limit, and again if a shorter path turns up.
//!
//! Source: Sturtevant and Rabin, "Canonical orderings on grids", IJCAI 2016, for grids without cut
//! corners as in Harabor and Grastien, "Improving jump point search", ICAPS 2014. Complexity: `O(cells + longest distance)`
//! but for what runs beyond their bucket write in vain.

use crate::buckets::Buckets;
use crate::octile::{DIAGONAL, FAR, STRAIGHT};
use crate::shape::{STEPS, Shape};

/// Longest run of straight steps that is written without the queue.
const RUN: u32 = 32;

/// Width of a bucket, as a power of two; no step is shorter.
const WIDTH: u32 = 13;

/// Buckets between a cell and the furthest one that is queued from it.
const REACH: u32 = ((RUN + 2) * STRAIGHT + DIAGONAL) >> WIDTH;

/// A cell: its length, the steps it allows, those of canonical paths through it that were taken or are queued, and
/// those that are queued; in this order from the highest bits.
#[derive(Clone, Copy)]
struct Record(u64);

impl Record {
    fn length(self) -> u32 {
        (self.0 >> 32) as u32
    }

    fn moves(self) -> u8 {
        (self.0 >> 16) as u8
    }

    fn known(self) -> u8 {
        (self.0 >> 8) as u8
    }

    fn queued(self) -> u8 {
        self.0 as u8
    }

    fn unreached(moves: u8) -> Self {
        Self(u64::from(FAR) << 32 | u64::from(moves) << 16)
    }

    /// The cell with a shorter path, which is continued by some steps.
    fn improved(self, length: u32, onward: u8, queued: u8) -> Self {
        Self(
            u64::from(length) << 32
                | self.0 & 0xff_0000
                | u64::from(onward) << 8
                | u64::from(queued),
        )
    }

    /// The cell with one more path of the same length.
    fn joined(self, onward: u8, queued: u8) -> Self {
        Self(self.0 | u64::from(onward) << 8 | u64::from(queued))
    }

    fn dequeued(self) -> Self {
        Self(self.0 & !0xff)
    }
}

/// Length of the shortest path from `source` to each cell over the allowed `moves`, in units of [`crate::octile`].
///
/// None if a path is too long for 32 bits.
#[must_use]
pub fn canonical_lengths(shape: Shape, moves: &[u8], source: u32) -> Option<Vec<u32>> {
    let mut search = Search {
        offsets: shape.offsets(),
        successors: canonical_successors(),
        records: moves
            .iter()
            .map(|&moves| Record::unreached(moves))
            .collect(),
        buckets: Buckets::new(REACH as usize + 1),
    };
    let first = &mut search.records[source as usize];
    *first = first.improved(0, u8::MAX, u8::MAX);
    search.buckets.push(0, source);
    while let Some((number, cells)) = search.buckets.pop() {
        if number + u64::from(REACH) >= u64::from(FAR >> WIDTH) {
            return None;
        }
        for &cell in &cells {
            // A shorter path may have settled it in an earlier bucket.
            if u64::from(search.records[cell as usize].length() >> WIDTH) == number {
                search.settle(cell as usize);
            }
        }
        search.buckets.give_back(cells);
    }
    Some(
        search
            .records
            .iter()
            .map(|record| record.length())
            .collect(),
    )
}

struct Search {
    offsets: [isize; 8],
    successors: [[u8; 256]; 8],
    records: Vec<Record>,
    buckets: Buckets,
}

impl Search {
    fn settle(&mut self, cell: usize) {
        let record = self.records[cell];
        self.records[cell] = record.dequeued();
        let mut open = record.queued() & record.moves();
        while open != 0 {
            let step = open.trailing_zeros() as usize;
            open &= open - 1;
            if step < 4 {
                self.run(cell, record, step);
            } else {
                self.step(cell, record, step);
            }
        }
    }

    /// A diagonal step.
    #[inline]
    fn step(&mut self, cell: usize, from: Record, step: usize) {
        let to = (cell as isize + self.offsets[step]) as usize;
        let length = from.length() + DIAGONAL;
        let onward = self.successors[step][from.moves() as usize];
        let record = self.records[to];
        if length < record.length() {
            self.records[to] = record.improved(length, onward, onward);
        } else if length == record.length() && onward & !record.known() != 0 {
            let fresh = onward & !record.known();
            self.records[to] = record.joined(fresh, fresh);
        } else {
            return;
        }
        self.buckets.push(u64::from(length >> WIDTH), to as u32);
    }

    /// Straight steps, as far as they are the canonical continuation.
    #[inline]
    fn run(&mut self, cell: usize, from: Record, step: usize) {
        let (offset, ahead) = (self.offsets[step], 1u8 << step);
        let (mut to, mut length, mut moves) = (cell, from.length(), from.moves());
        for count in 0..=RUN {
            to = (to as isize + offset) as usize;
            length += STRAIGHT;
            let onward = self.successors[step][moves as usize];
            let record = self.records[to];
            moves = record.moves();
            let (fresh, shorter) = if length < record.length() {
                (onward, true)
            } else if length == record.length() {
                (onward & !record.known(), false)
            } else {
                return;
            };
            let goes_on = fresh & moves & ahead != 0 && count < RUN;
            let queued = fresh & moves & !(if goes_on { ahead } else { 0 });
            self.records[to] = if shorter {
                record.improved(length, fresh, queued)
            } else {
                record.joined(fresh, queued)
            };
            if queued != 0 {
                self.buckets.push(u64::from(length >> WIDTH), to as u32);
            }
            if !goes_on {
                return;
            }
        }
    }
}

/// Steps that continue a canonical path, by its last step and the moves of the cell that it took it from.
///
/// After a diagonal step: the same step and its two components. After a straight step: the same step; on
/// a side where the cell before is an obstacle no diagonal came by, so the turn to that side, straight or
/// diagonally, continues it as well.
fn canonical_successors() -> [[u8; 256]; 8] {
    let bit = |rows: i64, columns: i64| {
        1u8 << STEPS
            .iter()
            .position(|&step| step == (rows, columns))
            .unwrap_or(0)
    };
    let mut table = [[0; 256]; 8];
    for (step, &(rows, columns)) in STEPS.iter().enumerate() {
        for (moves, entry) in table[step].iter_mut().enumerate() {
            *entry = 1 << step;
            if rows != 0 && columns != 0 {
                *entry |= bit(rows, 0) | bit(0, columns);
                continue;
            }
            for side in [(columns, rows), (-columns, -rows)] {
                if moves as u8 & bit(side.0, side.1) == 0 {
                    *entry |= bit(side.0, side.1) | bit(rows + side.0, columns + side.1);
                }
            }
        }
    }
    table
}
