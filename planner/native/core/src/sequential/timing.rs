//! Steps run one after the other in the real task.

use crate::epoch::search::Found;
use crate::epoch::transitions::Transitions;
use crate::task::OperatorId;

/// The plan that starts each operator when the one before has ended; `None` if a condition fails
/// or the goal is not reached.
#[must_use]
pub fn one_after_the_other(
    transitions: &Transitions<'_>,
    operators: &[OperatorId],
) -> Option<Found> {
    let mut state = transitions.initial();
    let mut steps = Vec::with_capacity(operators.len());
    let mut makespan: f64 = 0.0;
    for &operator in operators {
        let duration = transitions.duration(operator, &state, false);
        if !transitions.start(&mut state, operator, false) {
            return None;
        }
        let durative = transitions.compiled.operator(operator).duration.is_some();
        steps.push((operator, state.time, durative.then_some(duration)));
        makespan = makespan.max(state.time + duration);
        if !transitions.finish(&mut state) {
            return None;
        }
    }
    transitions.is_goal(&state).then(|| Found {
        cost: transitions.metric(&state, makespan).unwrap_or(makespan),
        steps,
    })
}
