//! Way points: a path of cells shortened wherever the straight line stays in passable cells.

use crate::shape::Shape;

/// Whether every cell touched by the segment between two cell centres is passable.
///
/// A segment through the corner of four cells touches all of them (supercover), so no corner is cut.
pub fn sees(shape: Shape, from: u32, to: u32, passable: impl Fn(u32) -> bool) -> bool {
    visit(shape, from, to, passable)
}

/// The cells touched by the segment between two cell centres, in its order.
#[must_use]
pub fn touched(shape: Shape, from: u32, to: u32) -> Vec<u32> {
    let mut cells = Vec::new();
    visit(shape, from, to, |cell| {
        cells.push(cell);
        true
    });
    cells
}

/// Visits the touched cells until one is refused; whether none was.
fn visit(shape: Shape, from: u32, to: u32, mut accept: impl FnMut(u32) -> bool) -> bool {
    let (mut row, mut column) = shape.row_column(from);
    let (last_row, last_column) = shape.row_column(to);
    let (rows, columns) = ((last_row - row).abs(), (last_column - column).abs());
    let (up, right) = ((last_row - row).signum(), (last_column - column).signum());
    let mut open = |row: i64, column: i64| shape.cell(row, column).is_some_and(&mut accept);
    // The next horizontal border is crossed at (2i + 1) / (2 rows), the next vertical one at (2j + 1) / (2 columns).
    let (mut i, mut j) = (0, 0);
    loop {
        if !open(row, column) {
            return false;
        }
        if i == rows && j == columns {
            return true;
        }
        let (horizontal, vertical) = ((2 * i + 1) * columns, (2 * j + 1) * rows);
        if j == columns || (i < rows && horizontal < vertical) {
            row += up;
            i += 1;
        } else if i == rows || vertical < horizontal {
            column += right;
            j += 1;
        } else {
            if !open(row + up, column) || !open(row, column + right) {
                return false;
            }
            row += up;
            column += right;
            i += 1;
            j += 1;
        }
    }
}

/// Keeps the first cell, the last, and those between which there is no line of sight.
///
/// The farthest visible cell is sought by doubling and halving, so a path of n cells needs about n log n cell tests.
pub fn way_points(shape: Shape, path: &[u32], passable: impl Fn(u32) -> bool) -> Vec<u32> {
    let Some(&first) = path.first() else {
        return Vec::new();
    };
    let mut points = vec![first];
    let mut here = 0;
    while here + 1 < path.len() {
        let visible = |index: usize| sees(shape, path[here], path[index], &passable);
        let mut good = here + 1;
        let mut reach = 2;
        while here + reach < path.len() && visible(here + reach) {
            good = here + reach;
            reach *= 2;
        }
        let mut bad = (here + reach).min(path.len());
        while good + 1 < bad {
            let middle = good.midpoint(bad);
            if visible(middle) {
                good = middle;
            } else {
                bad = middle;
            }
        }
        points.push(path[good]);
        here = good;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SHAPE: Shape = Shape {
        height: 12,
        width: 12,
    };

    /// Whether the closed square around a cell touches the segment between two centres.
    fn touches(cell: u32, from: u32, to: u32) -> bool {
        let ((row, column), (r0, c0), (r1, c1)) = (
            SHAPE.row_column(cell),
            SHAPE.row_column(from),
            SHAPE.row_column(to),
        );
        let (up, right) = (r1 - r0, c1 - c0);
        // Twice the coordinates, so that corners are integers; the four corners lie on one side or not.
        let side = |r: i64, c: i64| ((c - 2 * c0) * up - (r - 2 * r0) * right).signum();
        let sides: Vec<i64> = [(-1, -1), (-1, 1), (1, -1), (1, 1)]
            .iter()
            .map(|(a, b)| side(2 * row + a, 2 * column + b))
            .collect();
        let crosses = sides.iter().any(|&s| s >= 0) && sides.iter().any(|&s| s <= 0);
        let boxed =
            (r0.min(r1)..=r0.max(r1)).contains(&row) && (c0.min(c1)..=c0.max(c1)).contains(&column);
        crosses && boxed
    }

    proptest! {
        #[test]
        fn sees_equals_the_supercover(
            passable in proptest::collection::vec(proptest::bool::weighted(0.9), 144),
            from in 0u32..144,
            to in 0u32..144,
        ) {
            let clear = (0..144).filter(|&cell| touches(cell, from, to)).all(|cell| passable[cell as usize]);
            prop_assert_eq!(sees(SHAPE, from, to, |cell| passable[cell as usize]), clear);
        }
    }

    #[test]
    fn an_open_path_has_two_way_points() {
        let path: Vec<u32> = (0..12).map(|i| SHAPE.cell(i, i / 2).unwrap()).collect();
        assert_eq!(way_points(SHAPE, &path, |_| true), vec![path[0], path[11]]);
        assert_eq!(way_points(SHAPE, &path, |_| false), path);
    }
}
