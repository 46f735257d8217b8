//! Which of the eight steps each cell allows: one bit a step, no step off the grid and no cut corner.

use crate::shape::{STEPS, Shape};

/// Bits of the steps a cell allows, in the order of [`STEPS`].
pub fn moves_of(shape: Shape, cell: u32, passable: impl Fn(u32) -> bool) -> u8 {
    if !passable(cell) {
        return 0;
    }
    let (row, column) = shape.row_column(cell);
    let open = |rows: i64, columns: i64| {
        shape
            .cell(row + rows, column + columns)
            .is_some_and(&passable)
    };
    let mut moves = 0;
    for (step, &(rows, columns)) in STEPS.iter().enumerate() {
        let straight = rows == 0 || columns == 0;
        if open(rows, columns) && (straight || (open(rows, 0) && open(0, columns))) {
            moves |= 1 << step;
        }
    }
    moves
}

/// The moves of every cell; rows are computed from three rows at a time.
#[must_use]
pub fn all_moves(shape: Shape, passable: &[bool]) -> Vec<u8> {
    let width = shape.width;
    let padded = |row: Option<usize>| {
        let mut cells = vec![0u8; width + 2];
        if let Some(row) = row.filter(|&row| row < shape.height) {
            for (cell, &open) in cells[1..]
                .iter_mut()
                .zip(&passable[row * width..(row + 1) * width])
            {
                *cell = u8::from(open);
            }
        }
        cells
    };
    let mut moves = vec![0u8; shape.len()];
    let (mut here, mut above) = (padded(None), padded(Some(0)));
    for (row, out) in moves.chunks_mut(width.max(1)).enumerate() {
        let below = std::mem::replace(&mut here, above);
        above = padded(Some(row + 1));
        for (column, cell) in out.iter_mut().enumerate() {
            let (west, centre, east) = (column, column + 1, column + 2);
            let (e, n, w, s) = (here[east], above[centre], here[west], below[centre]);
            let bits = e
                | n << 1
                | w << 2
                | s << 3
                | (n & e & above[east]) << 4
                | (n & w & above[west]) << 5
                | (s & w & below[west]) << 6
                | (s & e & below[east]) << 7;
            *cell = if here[centre] == 1 { bits } else { 0 };
        }
    }
    moves
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn row_wise_moves_equal_the_definition(
            passable in proptest::collection::vec(proptest::bool::weighted(0.7), 7 * 9)
        ) {
            let shape = Shape { height: 7, width: 9 };
            let expected: Vec<u8> = (0..63)
                .map(|cell| moves_of(shape, cell, |other| passable[other as usize]))
                .collect();
            prop_assert_eq!(all_moves(shape, &passable), expected);
        }
    }
}
