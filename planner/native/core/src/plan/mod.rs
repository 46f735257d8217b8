//! Time-triggered plans, and their text.

mod parser;
pub mod reader;
pub mod writer;

/// Least time between two happenings of which one changes what the other reads or changes [s].
pub const EPSILON: f64 = 0.001;

/// Least distance from a whole nanosecond that is not taken for an error of floating point [s].
const DUST: f64 = 1e-10;

/// One step: an action with its start and duration.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Start [s].
    pub start: f64,
    /// Action name.
    pub action: String,
    /// Argument names.
    pub arguments: Vec<String>,
    /// Duration [s]; `None` for an instantaneous action.
    pub duration: Option<f64>,
}

impl Step {
    /// End [s].
    #[must_use]
    pub fn end(&self) -> f64 {
        self.start + self.duration.unwrap_or(0.0)
    }
}

impl std::fmt::Display for Step {
    /// `(drive e1 a b)`
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "({}", self.action)?;
        for argument in &self.arguments {
            write!(formatter, " {argument}")?;
        }
        write!(formatter, ")")
    }
}

/// A time [s] without the last digits that sums of floating point leave: the nearest nanosecond where
/// that is nearer than any sum of times comes by itself. Far less than what validators distinguish.
#[must_use]
pub fn without_dust(time: f64) -> f64 {
    let whole = (time * 1e9).round() / 1e9;
    if (whole - time).abs() < DUST {
        whole
    } else {
        time
    }
}

/// A time-triggered plan, sorted by start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Its steps.
    pub steps: Vec<Step>,
}

impl Plan {
    /// The time at which the last step ends [s].
    #[must_use]
    pub fn makespan(&self) -> f64 {
        without_dust(self.steps.iter().map(Step::end).fold(0.0, f64::max))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dust_goes_and_times_stay() {
        assert_eq!(without_dust(10.004_999_999_999_999), 10.005);
        assert_eq!(without_dust(252.001 + 132.000_999_999_999_95), 384.002);
        for time in [0.0, 1.0 / 3.0, 123.456_789_012_34, 1e12 + 0.25, f64::MAX] {
            assert_eq!(without_dust(time), time);
        }
    }
}
