//! Time-triggered plans, and their text.

mod parser;
pub mod reader;
pub mod writer;

/// Least time between two happenings of which one changes what the other reads or changes [s].
pub const EPSILON: f64 = 0.001;

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
        self.steps.iter().map(Step::end).fold(0.0, f64::max)
    }
}
