//! Lengths of paths as searches compare and add them.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::ops::Add;

use crate::field::{Field, Lengths, weighted_step};
use crate::octile;

/// A length of one of the two kinds in [`Lengths`].
pub trait Length: Copy + PartialOrd + Add<Output = Self> + Sized {
    /// Of a cell without path.
    const FAR: Self;

    /// An integer that compares as the length does.
    fn key(self) -> u64;

    /// In cells times multiplier, where that needs no path.
    fn in_cells(self) -> Option<f64>;

    /// The lengths of all cells.
    fn all(lengths: Vec<Self>) -> Lengths;
}

impl Length for u32 {
    const FAR: Self = octile::FAR;

    fn key(self) -> u64 {
        u64::from(self)
    }

    fn in_cells(self) -> Option<f64> {
        if self == Self::FAR {
            return Some(f64::INFINITY);
        }
        (self < octile::AMBIGUOUS).then(|| octile::cells(self, octile::diagonals(self)))
    }

    fn all(lengths: Vec<Self>) -> Lengths {
        Lengths::Octile(lengths)
    }
}

impl Length for f64 {
    const FAR: Self = Self::INFINITY;

    fn key(self) -> u64 {
        // The bits of floats above zero compare as they do.
        self.to_bits()
    }

    fn in_cells(self) -> Option<f64> {
        Some(self)
    }

    fn all(lengths: Vec<Self>) -> Lengths {
        Lengths::Weighted(lengths)
    }
}

/// Does the same with a field's lengths, whatever their kind, and its lengths of steps (from, to, step).
pub trait OfField {
    /// What is done.
    type Answer;

    /// Does it.
    fn with<L: Length>(self, lengths: &[L], edge: impl Fn(u32, u32, usize) -> L) -> Self::Answer;
}

/// Does `what` with the lengths of `field`.
pub fn with_lengths<W: OfField>(field: &Field, what: W) -> W::Answer {
    match &field.lengths {
        Lengths::Octile(lengths) => what.with(lengths, |_, _, step| octile::STEPS[step]),
        Lengths::Weighted(lengths) => {
            let factors = field.multiplier.as_ref().map(|factors| &factors[..]);
            what.with(lengths, |from, to, step| {
                weighted_step(factors, from as usize, to as usize, step)
            })
        }
    }
}

/// Hashes a cell by one multiplication: cells are spread well enough.
#[derive(Default)]
pub struct CellHasher(u64);

impl Hasher for CellHasher {
    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u32(u32::from(byte));
        }
    }

    fn write_u32(&mut self, cell: u32) {
        self.0 = (self.0 ^ u64::from(cell)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }

    fn finish(&self) -> u64 {
        self.0.rotate_left(32)
    }
}

/// A table by cell; its order never shows in an answer.
pub type CellMap<T> = HashMap<u32, T, BuildHasherDefault<CellHasher>>;
