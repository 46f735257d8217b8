//! The critical path of a schedule: the operators that the makespan waits for.

use crate::schedule::links::Element;
use crate::schedule::model::EPSILON;
use crate::schedule::state::State;

/// How much later than the end of another one an operator may start and still wait for it [s].
const TIGHT_S: f64 = 20.0 * EPSILON;

/// The anchors among the elements that the makespan waits for, last ones first. The schedule is that
/// of the elements, in their order; otherwise there are none.
pub(super) fn critical_anchors(elements: &[Element], state: &State) -> Vec<usize> {
    let mut anchors = Vec::new();
    if state.list.len() != elements.len() {
        return anchors;
    }
    let mut critical = vec![false; elements.len()];
    for (index, (element, dispatch)) in elements.iter().zip(&state.list).enumerate().rev() {
        let end = dispatch.end();
        let is_awaited = element.consumers.iter().any(|consumer| {
            let position = consumer.position as usize;
            critical.get(position) == Some(&true) && state.list[position].start <= end + TIGHT_S
        });
        critical[index] = is_awaited || end + EPSILON >= state.makespan;
        if critical[index] && element.is_anchor() {
            anchors.push(index);
        }
    }
    anchors
}

#[cfg(test)]
mod tests {
    use super::critical_anchors;
    use crate::schedule::testing::{FACTORY, elements, operator, task};
    use crate::schedule::workshop::Workshop;

    #[test]
    fn what_the_makespan_waits_for() {
        let task = task(FACTORY);
        let mut workshop = Workshop::new(&task, 0, None).expect("supported");
        let names = ["sweep", "prime", "paint", "pack"];
        let list = names.map(|name| operator(&task, name));
        assert!(workshop.replay(list.into_iter()));
        let elements = elements(&task, &workshop, &names);
        // Painting lasts longer than packing, which begins when painting does.
        assert_eq!(critical_anchors(&elements, &workshop.state), [2, 1]);
        assert!(critical_anchors(&elements[..3], &workshop.state).is_empty());
    }
}
