//! What is left of the plan in execution, in terms of a newly grounded task.

use rustc_hash::FxHashMap;

use crate::pddl::model::{ActionId, ObjectId};
use crate::plan::{Plan, Step};
use crate::task::{OperatorId, Task};

/// The operators of a plan by start; steps that the new task does not have are left out.
#[must_use]
pub fn operators(task: &Task, plan: &Plan) -> Vec<OperatorId> {
    let actions = numbered(&task.action_names);
    let objects = numbered(&task.object_names);
    let named = |step: &Step| -> Option<(ActionId, Vec<ObjectId>)> {
        let arguments = step.arguments.iter();
        let arguments = arguments.map(|name| objects.get(name.as_str()).copied().map(ObjectId));
        let action = actions.get(step.action.as_str()).copied();
        Some((ActionId(action?), arguments.collect::<Option<_>>()?))
    };
    let mut steps: Vec<_> = plan.steps.iter().collect();
    steps.sort_by(|left, right| left.start.total_cmp(&right.start));
    let wanted: Vec<_> = steps.into_iter().filter_map(named).collect();
    let mut found: FxHashMap<(ActionId, &[ObjectId]), Option<OperatorId>> = wanted
        .iter()
        .map(|(action, arguments)| ((*action, arguments.as_slice()), None))
        .collect();
    for (index, operator) in task.operators.iter().enumerate() {
        if let Some(slot) = found.get_mut(&(operator.action, operator.arguments.as_slice())) {
            slot.get_or_insert(OperatorId(index as u32));
        }
    }
    wanted
        .iter()
        .filter_map(|(action, arguments)| found[&(*action, arguments.as_slice())])
        .collect()
}

fn numbered(names: &[String]) -> FxHashMap<&str, u32> {
    names.iter().map(String::as_str).zip(0..).collect()
}
