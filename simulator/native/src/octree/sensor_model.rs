//! Log-odds update with clamping (Wurm, eq. 5.9).

/// Parameters of the inverse sensor model, all multiples of `quantum`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorModel {
    /// Log odds of one step of a stored byte.
    pub quantum: f64,
    /// Steps added by a beam that ends in the voxel.
    pub hit: i8,
    /// Steps added by a beam that passes through.
    pub miss: i8,
    /// Lower clamping threshold in steps.
    pub lowest: i8,
    /// Upper clamping threshold in steps.
    pub highest: i8,
}

/// Marks a voxel that was never observed.
pub const UNKNOWN: i8 = i8::MIN;

impl SensorModel {
    /// From log odds.
    ///
    /// # Errors
    /// Names the constant that is no multiple of the quantum, does not fit into a byte or has the wrong sign.
    pub fn new(
        quantum: f64,
        hit: f64,
        miss: f64,
        lowest: f64,
        highest: f64,
    ) -> Result<Self, String> {
        if !(quantum > 0.0 && quantum.is_finite()) {
            return Err(format!("quantum must be positive, not {quantum}"));
        }
        let steps = |name: &str, value: f64, positive: bool| -> Result<i8, String> {
            let steps = (value / quantum).round();
            if !value.is_finite() || (steps * quantum - value).abs() > 1e-6 {
                return Err(format!(
                    "{name} = {value} is not a multiple of the quantum {quantum}"
                ));
            }
            if steps.abs() > 127.0 {
                return Err(format!(
                    "{name} = {value} is more than 127 steps of the quantum {quantum}"
                ));
            }
            if (steps > 0.0) != positive {
                let sign = if positive { "positive" } else { "negative" };
                return Err(format!("{name} must be {sign}, not {value}"));
            }
            Ok(steps as i8)
        };
        Ok(Self {
            quantum,
            hit: steps("hit", hit, true)?,
            miss: steps("miss", miss, false)?,
            lowest: steps("lowest", lowest, false)?,
            highest: steps("highest", highest, true)?,
        })
    }

    /// The thesis's constants (section 5.5): 0.85, -0.4, clamped to -2 and 3.5.
    #[must_use]
    pub fn thesis() -> Self {
        Self {
            quantum: 0.05,
            hit: 17,
            miss: -8,
            lowest: -40,
            highest: 70,
        }
    }

    /// The value after one more measurement; an unknown voxel starts from even odds.
    #[inline]
    #[must_use]
    pub fn updated(&self, value: i8, hit: bool) -> i8 {
        let prior = if value == UNKNOWN {
            0
        } else {
            i16::from(value)
        };
        let step = i16::from(if hit { self.hit } else { self.miss });
        (prior + step).clamp(i16::from(self.lowest), i16::from(self.highest)) as i8
    }

    /// The value after a measurement that says these log odds; an unknown voxel starts from even odds.
    #[must_use]
    pub fn moved(&self, value: i8, log_odds: f64) -> i8 {
        let prior = if value == UNKNOWN {
            0.0
        } else {
            f64::from(value)
        };
        (prior + log_odds / self.quantum)
            .round()
            .clamp(f64::from(self.lowest), f64::from(self.highest)) as i8
    }

    /// Log odds of a stored value; NaN for an unknown voxel.
    #[must_use]
    pub fn log_odds(&self, value: i8) -> f64 {
        if value == UNKNOWN {
            f64::NAN
        } else {
            f64::from(value) * self.quantum
        }
    }

    /// The stored value nearest to given log odds, clamped.
    #[must_use]
    pub fn stored(&self, log_odds: f64) -> i8 {
        (log_odds / self.quantum)
            .round()
            .clamp(f64::from(self.lowest), f64::from(self.highest)) as i8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_agreeing_measurements_make_an_unknown_voxel_stable() {
        // Wurm, section 5.2.4: five integrations suffice with these thresholds.
        let model = SensorModel::thesis();
        for (hit, limit) in [(true, model.highest), (false, model.lowest)] {
            let mut value = UNKNOWN;
            for _ in 0..5 {
                assert_ne!(value, limit);
                value = model.updated(value, hit);
            }
            assert_eq!(value, limit);
            assert_eq!(model.updated(value, hit), limit);
        }
    }

    #[test]
    fn measurements_of_any_certainty_add_up_and_are_clamped() {
        let model = SensorModel::thesis();
        let once = model.moved(UNKNOWN, 1.2);
        assert_eq!(model.log_odds(once), 24.0 * 0.05);
        assert_eq!(model.moved(once, -1.2), 0);
        assert_eq!(model.moved(UNKNOWN, -9.0), model.lowest);
        assert_eq!(model.moved(once, f64::INFINITY), model.highest);
    }

    #[test]
    fn constants_that_bytes_cannot_hold_are_refused() {
        assert_eq!(
            SensorModel::new(0.05, 0.85, -0.4, -2.0, 3.5),
            Ok(SensorModel::thesis())
        );
        let error = SensorModel::new(0.1, 0.85, -0.4, -2.0, 3.5).unwrap_err();
        assert!(error.contains("hit = 0.85 is not a multiple"), "{error}");
        assert!(
            SensorModel::new(0.05, -0.85, -0.4, -2.0, 3.5)
                .unwrap_err()
                .contains("positive")
        );
        assert!(
            SensorModel::new(0.01, 0.85, -0.4, -2.0, 3.5)
                .unwrap_err()
                .contains("127")
        );
    }
}
