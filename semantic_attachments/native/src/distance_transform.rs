//! Exact Euclidean distance transform that also names the nearest obstacle of every cell.
//!
//! Meijster, Roerdink and Hesselink, "A General Algorithm for Computing Distance Transforms in
//! Linear Time", 2000: distances along columns, then the lower envelope of parabolas along rows.
//! Linear in the cells.

use crate::shape::Shape;

/// What stands for "no obstacle anywhere" in [`DistanceTransform::squared`].
pub const NO_OBSTACLE: u32 = u32::MAX;

/// Distances between cell centres, in cells.
pub struct DistanceTransform {
    /// Squared distance to the nearest obstacle; 0 on obstacles, [`NO_OBSTACLE`] without any.
    pub squared: Vec<u32>,
    /// The nearest obstacle's cell; the cell itself without any.
    pub nearest: Vec<u32>,
}

/// Distance and nearest obstacle of every cell; of equally near ones any.
#[must_use]
pub fn distance_transform(shape: Shape, obstacle: &[bool]) -> DistanceTransform {
    let width = shape.width;
    let nearest_row = nearest_in_columns(shape, obstacle);
    let mut squared = vec![NO_OBSTACLE; shape.len()];
    let mut nearest: Vec<u32> = (0..shape.len() as u32).collect();
    let mut hull: Vec<Parabola> = Vec::with_capacity(width);
    for row in 0..shape.height {
        let begin = row * width;
        lower_envelope(&nearest_row[begin..begin + width], row, &mut hull);
        let mut at = 0;
        for column in 0..width {
            while at + 1 < hull.len() && hull[at + 1].from <= column as i64 {
                at += 1;
            }
            if let Some(parabola) = hull.get(at) {
                let apart = column as i64 - parabola.column;
                squared[begin + column] = (apart * apart + parabola.height) as u32;
                nearest[begin + column] = (parabola.row * width as i64 + parabola.column) as u32;
            }
        }
    }
    DistanceTransform { squared, nearest }
}

/// Row of the nearest obstacle in each cell's column; -1 in columns without one.
fn nearest_in_columns(shape: Shape, obstacle: &[bool]) -> Vec<i32> {
    let width = shape.width;
    let mut rows = vec![-1i32; shape.len()];
    for (row, line) in obstacle.chunks(width).enumerate() {
        for (column, &is_obstacle) in line.iter().enumerate() {
            let cell = row * width + column;
            if is_obstacle {
                rows[cell] = row as i32;
            } else if row > 0 {
                rows[cell] = rows[cell - width];
            }
        }
    }
    for row in (0..shape.height.saturating_sub(1)).rev() {
        for column in 0..width {
            let cell = row * width + column;
            let (above, here) = (rows[cell + width], rows[cell]);
            let is_nearer = here < 0 || above - (row as i32) < row as i32 - here;
            if above > row as i32 && is_nearer {
                rows[cell] = above;
            }
        }
    }
    rows
}

/// One column's squared distances along a row: `(x - column)^2 + height`, least from `from` on.
struct Parabola {
    column: i64,
    row: i64,
    height: i64,
    from: i64,
}

fn lower_envelope(nearest_row: &[i32], row: usize, hull: &mut Vec<Parabola>) {
    hull.clear();
    for (column, &obstacle_row) in nearest_row.iter().enumerate() {
        if obstacle_row < 0 {
            continue;
        }
        let (column, obstacle_row) = (column as i64, i64::from(obstacle_row));
        let height = (obstacle_row - row as i64).pow(2);
        let mut from = 0;
        while let Some(last) = hull.last() {
            // The first column at which the new parabola is lower.
            let rise = column * column + height - last.column * last.column - last.height;
            from = rise.div_euclid(2 * (column - last.column)) + 1;
            if from > last.from {
                break;
            }
            hull.pop();
            from = 0;
        }
        if from < nearest_row.len() as i64 {
            hull.push(Parabola {
                column,
                row: obstacle_row,
                height,
                from,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn distances_are_those_of_the_nearest_obstacle(
            width in 1usize..14, height in 1usize..14, bits in proptest::collection::vec(0u8..6, 196),
        ) {
            let shape = Shape { height, width };
            let obstacle: Vec<bool> = bits[..shape.len()].iter().map(|&bit| bit == 0).collect();
            let found = distance_transform(shape, &obstacle);
            let apart = |a: u32, b: u32| {
                let ((r, c), (s, d)) = (shape.row_column(a), shape.row_column(b));
                ((r - s).pow(2) + (c - d).pow(2)) as u32
            };
            for cell in 0..shape.len() as u32 {
                let least = (0..shape.len() as u32)
                    .filter(|&other| obstacle[other as usize])
                    .map(|other| apart(cell, other))
                    .min();
                prop_assert_eq!(found.squared[cell as usize], least.unwrap_or(NO_OBSTACLE));
                if least.is_some() {
                    let nearest = found.nearest[cell as usize];
                    prop_assert!(obstacle[nearest as usize]);
                    prop_assert_eq!(apart(cell, nearest), found.squared[cell as usize]);
                }
            }
        }
    }
}
