//! Octile lengths as integers: a straight step is 13860 long and a diagonal one 19601.
//!
//! 19601 / 13860 is a convergent of the square root of two (1.8e-9 above it), so two paths compare as their true lengths do
//! unless their numbers of diagonal steps differ by 13860 or more; both numbers are read back from the length. Sums
//! are exact: the steps of a shortest path need not be stored, because they are the ones whose lengths add up.

/// Length of a straight step.
pub const STRAIGHT: u32 = 13860;
/// Length of a diagonal step.
pub const DIAGONAL: u32 = 19601;
/// Length of a cell without path.
pub const FAR: u32 = u32::MAX;
/// Lengths from here on may have another number of diagonal steps than [`diagonals`] says.
pub const AMBIGUOUS: u32 = STRAIGHT * DIAGONAL;

/// Length of each of the eight steps, in the order of [`crate::shape::STEPS`].
pub const STEPS: [u32; 8] = [
    STRAIGHT, STRAIGHT, STRAIGHT, STRAIGHT, DIAGONAL, DIAGONAL, DIAGONAL, DIAGONAL,
];

/// Number of diagonal steps in a path of some length below [`AMBIGUOUS`].
#[must_use]
pub fn diagonals(length: u32) -> u32 {
    // 5741 is 19601 modulo 13860, and its own inverse.
    (u64::from(length) * 5741 % u64::from(STRAIGHT)) as u32
}

/// Length in cells of a path with so many diagonal steps.
#[must_use]
pub fn cells(length: u32, diagonals: u32) -> f64 {
    let straight =
        (i64::from(length) - i64::from(DIAGONAL) * i64::from(diagonals)) / i64::from(STRAIGHT);
    straight as f64 + f64::from(diagonals) * std::f64::consts::SQRT_2
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn steps_are_read_back(straight in 0u32..19_601, diagonal in 0u32..13_860) {
            let length = u64::from(straight * STRAIGHT) + u64::from(diagonal) * u64::from(DIAGONAL);
            prop_assume!(length < u64::from(AMBIGUOUS));
            let length = length as u32;
            prop_assert_eq!(diagonals(length), diagonal);
            let expected = f64::from(straight) + f64::from(diagonal) * std::f64::consts::SQRT_2;
            prop_assert_eq!(cells(length, diagonal), expected);
        }

        #[test]
        fn integers_compare_as_lengths_do(
            a in (0u32..10_000, 0u32..13_860),
            b in (0u32..10_000, 0u32..13_860),
            close in any::<bool>(),
        ) {
            // Straight steps that make up for the difference in diagonal ones as well as possible.
            let made_up = (f64::from(a.1) - f64::from(b.1)) * std::f64::consts::SQRT_2;
            let straight = f64::from(a.0) + made_up.round();
            let b = if close && straight >= 0.0 { (straight as u32, b.1) } else { b };
            let integer = |(s, d): (u32, u32)| u64::from(s) * u64::from(STRAIGHT) + u64::from(d) * u64::from(DIAGONAL);
            // s - s' against (d' - d) * sqrt(2), squared, without rounding.
            let (straight, diagonal) = (i64::from(a.0) - i64::from(b.0), i64::from(b.1) - i64::from(a.1));
            let expected = match (straight.signum(), diagonal.signum()) {
                (1, 1) => (straight * straight).cmp(&(2 * diagonal * diagonal)),
                (-1, -1) => (2 * diagonal * diagonal).cmp(&(straight * straight)),
                (x, y) => x.cmp(&y),
            };
            prop_assert_eq!(integer(a).cmp(&integer(b)), expected);
        }
    }
}
