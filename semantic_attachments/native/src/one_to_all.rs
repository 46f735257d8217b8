//! Distances from one cell to all others.

use std::sync::Arc;

use crate::canonical::canonical_lengths;
use crate::field::{Field, Lengths};
use crate::shape::Shape;
use crate::weighted::weighted_lengths;

/// Grows the shortest-path tree of `source` over the allowed `moves`.
///
/// `multiplier` scales the length of a step by the mean of its two cells; each must be at least 1.
#[must_use]
pub fn one_to_all(
    shape: Shape,
    moves: Arc<Vec<u8>>,
    multiplier: Option<Arc<Vec<f32>>>,
    source: u32,
) -> Field {
    let octile = match multiplier {
        None => canonical_lengths(shape, &moves, source).map(Lengths::Octile),
        Some(_) => None,
    };
    let factors = multiplier.as_ref().map(|factors| &factors[..]);
    let lengths = octile
        .unwrap_or_else(|| Lengths::Weighted(weighted_lengths(shape, &moves, source, factors)));
    Field {
        shape,
        source,
        lengths,
        moves,
        multiplier,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::mean_factor;
    use crate::moves::all_moves;
    use crate::shape::STEP_LENGTHS;
    use proptest::prelude::*;

    /// Bellman-Ford: relaxes all edges until nothing changes.
    fn by_relaxation(shape: Shape, moves: &[u8], factors: &[f32], source: u32) -> Vec<f64> {
        let mut distances = vec![f64::INFINITY; shape.len()];
        distances[source as usize] = 0.0;
        loop {
            let before = distances.clone();
            for cell in 0..shape.len() as u32 {
                for (step, length) in STEP_LENGTHS.iter().enumerate() {
                    if moves[cell as usize] >> step & 1 == 1 {
                        let to = shape.neighbour(cell, step).unwrap() as usize;
                        let factor = mean_factor(factors, cell as usize, to);
                        distances[to] =
                            distances[to].min(distances[cell as usize] + length * factor);
                    }
                }
            }
            if before == distances {
                return distances;
            }
        }
    }

    #[test]
    fn an_empty_grid_has_octile_distances() {
        let shape = Shape {
            height: 20,
            width: 30,
        };
        let moves = all_moves(shape, &vec![true; shape.len()]);
        let source = shape.cell(7, 11).unwrap();
        let field = one_to_all(shape, Arc::new(moves), None, source);
        for cell in 0..shape.len() as u32 {
            let expected = crate::shape::octile(shape.row_column(cell), (7, 11));
            assert!((field.distance(cell) - expected).abs() < 1e-9);
            assert_eq!(field.path_to(cell).first(), Some(&source));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1500))]

        #[test]
        fn equals_relaxation_on_random_grids(
            passable in proptest::collection::vec(proptest::bool::weighted(0.75), 12 * 9),
            factors in proptest::collection::vec(1.0f32..6.0, 12 * 9),
            weighted in any::<bool>(),
            source in 0u32..108,
        ) {
            let shape = Shape { height: 12, width: 9 };
            let moves = all_moves(shape, &passable);
            let factors = if weighted { factors } else { vec![1.0; 108] };
            let multiplier = weighted.then(|| Arc::new(factors.clone()));
            let field = one_to_all(shape, Arc::new(moves.clone()), multiplier, source);
            for (found, expected) in field.distances().iter().zip(by_relaxation(shape, &moves, &factors, source)) {
                prop_assert!(*found == expected || (found - expected).abs() < 1e-9);
            }
        }

        #[test]
        fn a_path_is_as_long_as_its_distance(
            passable in proptest::collection::vec(proptest::bool::weighted(0.8), 12 * 9),
            source in 0u32..108,
            goal in 0u32..108,
        ) {
            let shape = Shape { height: 12, width: 9 };
            let moves = all_moves(shape, &passable);
            let field = one_to_all(shape, Arc::new(moves), None, source);
            let path = field.path_to(goal);
            prop_assert_eq!(path.is_empty(), field.distance(goal).is_infinite());
            let length: f64 = path.windows(2).map(|pair| {
                crate::shape::octile(shape.row_column(pair[0]), shape.row_column(pair[1]))
            }).sum();
            prop_assert!(path.is_empty() || (length - field.distance(goal)).abs() < 1e-9);
        }
    }
}
