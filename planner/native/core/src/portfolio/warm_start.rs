//! What is left of the plan in execution, in terms of a newly grounded task.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use rustc_hash::FxHashMap;

use crate::attachment::Attachments;
use crate::epoch::calls::Calls;
use crate::epoch::compiled::Compiled;
use crate::epoch::search::Found;
use crate::epoch::transitions::Transitions;
use crate::pddl::model::{ActionId, ObjectId};
use crate::plan::{Plan, Step};
use crate::schedule::{Limits, Optimiser};
use crate::task::{OperatorId, Task};

use super::from_schedule;
use super::incumbent::Incumbent;

static NEVER: AtomicBool = AtomicBool::new(false);

/// Repairs what is left of the plan and offers it before anything else is prepared, so that a robot
/// team has a plan in force again at once. False if the list search cannot be trusted here.
pub(super) fn put_in_force(
    optimiser: &mut Optimiser<'_>,
    operators: &[OperatorId],
    (task, attachments): (&Task, &dyn Attachments),
    (deadline, cancel): (Option<Instant>, Option<&AtomicBool>),
    incumbent: &mut Incumbent<'_>,
) -> bool {
    let limits = Limits {
        deadline,
        patience: None,
        cancel: cancel.unwrap_or(&NEVER),
        nodes: None,
    };
    let mut sound = true;
    optimiser.adopt(operators, &limits, &mut |schedule| {
        let found = from_schedule(schedule);
        sound = executes(task, attachments, &found);
        if sound {
            incumbent.offer(&found);
        }
    });
    incumbent.report.schedules = optimiser.nodes();
    sound
}

/// Whether a plan reaches the goal in the decision-epoch space, of which only its own operators
/// are prepared.
fn executes(task: &Task, attachments: &dyn Attachments, found: &Found) -> bool {
    let mut used: Vec<OperatorId> = found.steps.iter().map(|step| step.0).collect();
    used.sort_unstable();
    used.dedup();
    let compiled = Compiled::only(task, &used);
    let calls = Calls::new(task, attachments);
    let transitions = Transitions {
        compiled: &compiled,
        calls: &calls,
    };
    let steps = found.steps.iter().map(|&(operator, start, duration)| {
        let position = used.partition_point(|other| *other < operator);
        (OperatorId(position as u32), start, duration)
    });
    let state = transitions.execute(&steps.collect::<Vec<_>>());
    state.is_some_and(|state| transitions.is_goal(&state))
}

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
