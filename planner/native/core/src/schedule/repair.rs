//! Executing a changed list: what still applies is applied, what does not is substituted or
//! achieved anew, what is no longer needed is left out.

use rand::RngExt;
use rand::seq::SliceRandom;

use crate::schedule::links::{Element, Links, Role};
use crate::schedule::model::NONE;
use crate::schedule::question::{Labelling, Restriction};
use crate::schedule::workshop::Workshop;

/// One entry of a changed list.
#[derive(Clone, Copy, Debug)]
pub enum Item<'e> {
    /// An operator of the list it was made from.
    Keep(&'e Element, Tail),
    /// A proposition to achieve here, and how long it takes from then on until all is over that waits
    /// for it [s].
    Achieve(u32, Restriction, f64),
    /// From here on, a proposition is not to be achieved.
    Without(u32),
}

/// How long it takes, from the end of an operator on, until all is over that waits for it [s].
#[derive(Clone, Copy, Debug, Default)]
pub struct Tail {
    /// For anything that it achieves.
    pub any: f64,
    /// For what it has to achieve anew if it cannot run.
    pub primary: f64,
}

impl Workshop {
    /// Executes a changed list and achieves the goals that it leaves open. False if that fails, or if
    /// an operator with what has to follow it would not be over before the bound.
    pub fn repair(
        &mut self,
        items: &[Item<'_>],
        mut labelling: Labelling,
        bound: f64,
        stop: &dyn Fn() -> bool,
    ) -> bool {
        let beginning = items.iter().map_while(|item| match item {
            Item::Keep(element, _) => Some(element.operator),
            Item::Achieve(..) | Item::Without(_) => None,
        });
        let kept = self.start_over(beginning);
        if kept > 0 && self.state.makespan >= bound {
            return false;
        }
        let faithful = self.random.random_bool(0.8);
        let mend_transit = self.random.random_bool(0.5);
        for item in &items[kept..] {
            match *item {
                Item::Without(proposition) => labelling.without = proposition,
                Item::Achieve(proposition, restriction, tail) => {
                    let bound = bound - tail;
                    if !self.holds(proposition)
                        && !self.achieve(proposition, labelling, restriction, bound, stop)
                        && self.late
                    {
                        return false;
                    }
                }
                Item::Keep(element, tail) => {
                    let served = !element.purposes.is_empty()
                        && element
                            .purposes
                            .iter()
                            .all(|(fact, value)| self.state.holds(*fact, *value));
                    if served {
                        continue;
                    }
                    if let Some(end) = self.append(element.operator) {
                        if end + tail.any >= bound {
                            return false;
                        }
                        continue;
                    }
                    if element.primary == NONE
                        || self.holds(element.primary)
                        || (element.role == Role::Transit && !mend_transit)
                    {
                        continue;
                    }
                    let bound = bound - tail.primary;
                    match self.substitute(element.primary, element.operator, faithful) {
                        Some(other) => {
                            if self.append(other.operator).is_some_and(|end| end >= bound) {
                                return false;
                            }
                        }
                        None if element.role == Role::Transit => {}
                        None => {
                            if stop() {
                                return false;
                            }
                            let free = Restriction::None;
                            self.achieve(element.primary, labelling, free, bound, stop);
                            if self.late {
                                return false;
                            }
                        }
                    }
                }
            }
            if self.state.list.len() > self.longest {
                return false;
            }
        }
        if self.goal_holds() {
            return true;
        }
        let mut order = self.propositions.goal.clone();
        order.shuffle(&mut self.random);
        self.achieve_goals(&mut order, labelling, bound, stop)
    }

    /// The operators of the schedule by start.
    fn by_start(&self) -> Vec<u32> {
        let mut list = self.state.list.clone();
        list.sort_by(|left, right| left.start.total_cmp(&right.start));
        list.iter().map(|dispatch| dispatch.operator).collect()
    }

    /// Whether pruning would only give back the elements of a list that was pruned before: the
    /// schedule has the same operators by start and is worth no less (`value`: what the list is).
    pub fn is_again(&self, elements: &[Element], value: f64) -> bool {
        self.state.list.len() == elements.len()
            && self.value() + 1e-9 >= value
            && self
                .by_start()
                .iter()
                .eq(elements.iter().map(|element| &element.operator))
    }

    /// Leaves out what the schedule does not need and sorts it by start, as far as it stays
    /// executable and does not become worse. The schedule must reach the goal; returns its
    /// elements.
    pub fn prune(&mut self, links: &mut Links) -> Vec<Element> {
        let value = self.value() + 1e-9;
        let list = self.state.list.clone();
        let original: Vec<u32> = list.iter().map(|dispatch| dispatch.operator).collect();
        let by_start = self.by_start();
        for base in [&by_start, &original] {
            for cautious in [false, true] {
                let mut operators = base.clone();
                let elements = loop {
                    let elements =
                        links.elements(&self.model, &self.propositions, &operators, cautious);
                    let needed = |element: &&Element| element.role != Role::Useless;
                    if elements.iter().all(|element| needed(&element)) {
                        break elements;
                    }
                    let needed = elements.iter().filter(needed);
                    operators = needed.map(|element| element.operator).collect();
                };
                if self.replay(operators.iter().copied())
                    && self.goal_holds()
                    && self.value() <= value
                {
                    return elements;
                }
            }
        }
        // An envelope may have been there for something else when it started: take the times as they were.
        self.reset();
        for dispatch in list {
            self.state.apply(&self.model, dispatch);
        }
        self.tighten_envelopes();
        links.elements(&self.model, &self.propositions, &original, true)
    }
}

#[cfg(test)]
mod tests {
    use super::{Item, Tail};
    use crate::schedule::question::Restriction;
    use crate::schedule::testing::{FACTORY, elements, task};
    use crate::schedule::workshop::Workshop;

    #[test]
    fn a_list_is_given_up_before_what_would_be_late() {
        let task = task(FACTORY);
        let mut workshop = Workshop::new(&task, 0, None).expect("supported");
        let list = elements(&task, &workshop, &["prime"]);
        let labelling = workshop.labelling();
        let tail = Tail {
            any: 3.0,
            primary: 3.0,
        };
        let items = [Item::Keep(&list[0], tail)];
        assert!(!workshop.repair(&items, labelling, 7.0, &|| false));
        assert_eq!(workshop.state.list.len(), 1);
        assert!(workshop.repair(&items, labelling, 7.1, &|| false));
        assert!(workshop.state.makespan < 7.1);
    }

    #[test]
    fn what_cannot_be_there_in_time_is_not_begun() {
        let task = task(FACTORY);
        let mut workshop = Workshop::new(&task, 0, None).expect("supported");
        let goals = workshop.propositions.goal.clone();
        assert_eq!(workshop.reach.len(), goals.len());
        let mut labelling = workshop.labelling();
        labelling.noise = 0.0;
        let free = Restriction::None;
        // Priming takes 4 s, packing may begin when painting does.
        for (index, goal) in goals.into_iter().enumerate() {
            if workshop.reach[index] < 5.0 {
                continue;
            }
            workshop.reset();
            assert!(!workshop.achieve(goal, labelling, free, 6.0, &|| false));
            assert!(workshop.late && workshop.state.list.is_empty());
            workshop.reset();
            assert!(workshop.achieve(goal, labelling, free, 7.1, &|| false));
            assert!(!workshop.late);
        }
    }
}
