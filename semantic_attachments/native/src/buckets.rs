//! A queue of cells by length, in buckets that are no wider than an edge is short.
//!
//! Source: Denardo and Fox, "Shortest-route methods: 1. Reaching, pruning, and buckets", Operations
//! Research 27(1), 1979. No edge leads back into the bucket that is being settled, so its cells may be settled in any
//! order and the lengths are exact; a queue operation costs a constant.

/// Cells to be settled, by the number of their bucket.
pub struct Buckets {
    ring: Vec<Vec<u32>>,
    waiting: usize,
    number: u64,
    settling: Vec<u32>,
}

impl Buckets {
    /// A queue for cells at most `reach` buckets ahead of the one that is being settled.
    #[must_use]
    pub fn new(reach: usize) -> Self {
        Self {
            // A power of two, so that the slot is a matter of a mask.
            ring: vec![Vec::new(); (reach + 1).next_power_of_two()],
            waiting: 0,
            number: 0,
            settling: Vec::new(),
        }
    }

    /// Adds a cell to a bucket.
    #[inline]
    pub fn push(&mut self, number: u64, cell: u32) {
        let slot = number as usize & (self.ring.len() - 1);
        self.ring[slot].push(cell);
        self.waiting += 1;
    }

    /// The cells of the next bucket, and its number; the vector is to be given back.
    pub fn pop(&mut self) -> Option<(u64, Vec<u32>)> {
        if self.waiting == 0 {
            return None;
        }
        let number = self.number;
        let slot = number as usize & (self.ring.len() - 1);
        let cells = std::mem::replace(&mut self.ring[slot], std::mem::take(&mut self.settling));
        self.waiting -= cells.len();
        self.number += 1;
        Some((number, cells))
    }

    /// Takes back what `pop` gave.
    pub fn give_back(&mut self, mut cells: Vec<u32>) {
        cells.clear();
        self.settling = cells;
    }
}
