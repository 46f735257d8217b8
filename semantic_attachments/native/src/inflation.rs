//! Inflation of obstacles by a robot's radius with exact Euclidean distances.
//!
//! A cell is covered when its centre is nearer than the radius to the square of an obstacle's cell, so a robot
//! whose centre is on the centre of a cell that is not covered touches nothing. Whatever lies outside of the
//! map is an obstacle, too. Because the
//! radius is a few cells, each row's distance to the nearest obstacle is compared with the half width
//! of the disc at every row offset: `O(cells * radius)` simple comparisons.

use crate::shape::Shape;

/// The disc as `(row offset, half width in cells)`; a negative half width covers nothing.
#[must_use]
pub fn disc(radius_cells: f64) -> Vec<(i64, i64)> {
    // Touching is allowed: a corridor exactly as wide as the robot lets it through.
    let radius = radius_cells - 1e-9;
    let reach = (radius + 0.5).ceil().max(0.0) as i64;
    (-reach..=reach)
        .filter_map(|row| {
            let vertical = (row.abs() as f64 - 0.5).max(0.0);
            if row == 0 || vertical < radius {
                let chord = (radius * radius - vertical * vertical).max(0.0).sqrt();
                // The nearest edge of a square `column` cells away is at `column - 0.5`.
                let half = if radius > 0.0 {
                    (chord + 0.5).ceil() as i64 - 1
                } else {
                    0
                };
                Some((row, half.max(0)))
            } else {
                None
            }
        })
        .collect()
}

/// Marks every cell covered by the obstacles and the outside of the map inflated by the radius.
#[must_use]
pub fn inflate(shape: Shape, obstacle: &[bool], radius_cells: f64) -> Vec<bool> {
    let width = shape.width;
    let far = u16::MAX;
    let mut gap = vec![far; shape.len()];
    for (gap_row, row) in gap.chunks_mut(width).zip(obstacle.chunks(width)) {
        sweep(gap_row.iter_mut().zip(row));
        let mut since = far;
        for (distance, &is_obstacle) in gap_row.iter_mut().zip(row).rev() {
            since = if is_obstacle {
                0
            } else {
                since.saturating_add(1)
            };
            *distance = (*distance).min(since);
        }
    }
    let mut covered = vec![false; shape.len()];
    for (offset, half) in disc(radius_cells) {
        let half = half.min(i64::from(far) - 1) as u16;
        for row in 0..shape.height as i64 {
            let source = row + offset;
            if source < 0 || source >= shape.height as i64 {
                continue;
            }
            let (into, from) = (row as usize * width, source as usize * width);
            for (cell, &distance) in covered[into..into + width]
                .iter_mut()
                .zip(&gap[from..from + width])
            {
                *cell |= distance <= half;
            }
        }
    }
    // Cells whose centres are nearer than the radius to the border.
    let rim = ((radius_cells - 1e-9 - 0.5).ceil().max(0.0) as usize).min(width.max(shape.height));
    for (row, line) in covered.chunks_mut(width).enumerate() {
        if row < rim || shape.height - row <= rim {
            line.fill(true);
        } else {
            let rim = rim.min(width);
            line[..rim].fill(true);
            line[width - rim..].fill(true);
        }
    }
    covered
}

fn sweep<'a>(cells: impl Iterator<Item = (&'a mut u16, &'a bool)>) {
    let mut since = u16::MAX;
    for (distance, &is_obstacle) in cells {
        since = if is_obstacle {
            0
        } else {
            since.saturating_add(1)
        };
        *distance = since;
    }
}

/// The cells covered by a few obstacle cells inflated by the radius, sorted, each once.
#[must_use]
pub fn inflate_cells(shape: Shape, obstacles: &[u32], radius_cells: f64) -> Vec<u32> {
    let disc = disc(radius_cells);
    let mut covered: Vec<u32> = obstacles
        .iter()
        .flat_map(|&cell| {
            let (row, column) = shape.row_column(cell);
            disc.iter().flat_map(move |&(offset, half)| {
                (-half..=half).filter_map(move |shift| shape.cell(row + offset, column + shift))
            })
        })
        .collect();
    covered.sort_unstable();
    covered.dedup();
    covered
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn by_definition(shape: Shape, obstacle: &[bool], radius: f64, outside: bool) -> Vec<bool> {
        (0..shape.len() as u32)
            .map(|cell| {
                let (row, column) = shape.row_column(cell);
                let (above, right) = (
                    shape.height as i64 - 1 - row,
                    shape.width as i64 - 1 - column,
                );
                let border = row.min(column).min(above).min(right) as f64 + 0.5;
                (outside && border < radius - 1e-9)
                    || (0..shape.len() as u32)
                        .filter(|&other| obstacle[other as usize])
                        .any(|other| {
                            let (r, c) = shape.row_column(other);
                            let vertical = ((row - r).abs() as f64 - 0.5).max(0.0);
                            let horizontal = ((column - c).abs() as f64 - 0.5).max(0.0);
                            other == cell || vertical.hypot(horizontal) < radius - 1e-9
                        })
            })
            .collect()
    }

    proptest! {
        #[test]
        fn equals_the_definition(
            cells in proptest::collection::vec(proptest::bool::weighted(0.08), 11 * 13),
            radius in prop_oneof![Just(0.0), Just(0.5), Just(1.5), 0.0..5.0],
        ) {
            let shape = Shape { height: 11, width: 13 };
            prop_assert_eq!(inflate(shape, &cells, radius), by_definition(shape, &cells, radius, true));
            let expected = by_definition(shape, &cells, radius, false);
            let obstacles: Vec<u32> = (0..shape.len() as u32).filter(|&i| cells[i as usize]).collect();
            let covered = inflate_cells(shape, &obstacles, radius);
            let listed: Vec<u32> = (0..shape.len() as u32).filter(|&i| expected[i as usize]).collect();
            prop_assert_eq!(covered, listed);
        }
    }
}
