//! What the search of list schedules finds.

use crate::plan::Plan;
use crate::task::{OperatorId, Task};

/// One operator of a plan with its start and duration [s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScheduledOperator {
    /// Which.
    pub operator: OperatorId,
    /// Start [s].
    pub start: f64,
    /// Duration [s]; `None` for an instantaneous action.
    pub duration: Option<f64>,
}

/// A valid plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Its operators, by start.
    pub operators: Vec<ScheduledOperator>,
    /// End of the last one [s].
    pub makespan: f64,
    /// What was minimised: the makespan with its share of the mean goal time, or the metric (negated
    /// to maximise).
    pub cost: f64,
}

impl Schedule {
    /// The plan with names.
    #[must_use]
    pub fn plan(&self, task: &Task) -> Plan {
        let steps = self
            .operators
            .iter()
            .map(|entry| task.step(entry.operator, entry.start, entry.duration));
        Plan {
            steps: steps.collect(),
        }
    }
}
