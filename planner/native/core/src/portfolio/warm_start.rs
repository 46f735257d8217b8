//! What is left of the plan in execution, in terms of a newly grounded task.

use rustc_hash::FxHashMap;

use crate::plan::{Plan, Step};
use crate::task::{OperatorId, Task};

/// The operators of a plan by start; steps that the new task does not have are left out.
#[must_use]
pub fn operators(task: &Task, plan: &Plan) -> Vec<OperatorId> {
    let name = |step: &Step| {
        std::iter::once(&step.action)
            .chain(&step.arguments)
            .cloned()
            .collect::<Vec<_>>()
            .join(" ")
    };
    let mut wanted: FxHashMap<String, Option<OperatorId>> =
        plan.steps.iter().map(|step| (name(step), None)).collect();
    for index in 0..task.operators.len() as u32 {
        if let Some(slot) = wanted.get_mut(&task.operator_name(OperatorId(index))) {
            slot.get_or_insert(OperatorId(index));
        }
    }
    let mut steps: Vec<_> = plan.steps.iter().collect();
    steps.sort_by(|left, right| left.start.total_cmp(&right.start));
    steps
        .into_iter()
        .filter_map(|step| wanted[&name(step)])
        .collect()
}
