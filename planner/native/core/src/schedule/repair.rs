//! Executing a changed list: what still applies is applied, what does not is substituted or
//! achieved anew, what is no longer needed is left out.

use rand::RngExt;
use rand::seq::SliceRandom;

use crate::schedule::links::{Element, Links, Role};
use crate::schedule::model::NONE;
use crate::schedule::question::{Labelling, Restriction};
use crate::schedule::workshop::Workshop;

/// One entry of a changed list.
#[derive(Clone, Debug)]
pub enum Item<'e> {
    /// An operator of the list it was made from.
    Keep(&'e Element),
    /// A proposition to achieve here.
    Achieve(u32, Restriction),
}

impl Workshop {
    /// Executes a changed list and achieves the goals that it leaves open. False if that fails or
    /// an operator would end after the bound.
    pub fn repair(
        &mut self,
        items: &[Item<'_>],
        labelling: Labelling,
        bound: f64,
        stop: &dyn Fn() -> bool,
    ) -> bool {
        let beginning = items.iter().map_while(|item| match item {
            Item::Keep(element) => Some(element.operator),
            Item::Achieve(..) => None,
        });
        let kept = self.start_over(beginning);
        if kept > 0 && self.state.makespan >= bound {
            return false;
        }
        let faithful = self.random.random_bool(0.8);
        let mend_transit = self.random.random_bool(0.5);
        for item in &items[kept..] {
            match item {
                Item::Achieve(proposition, restriction) => {
                    if !self.holds(*proposition)
                        && !self.achieve(*proposition, labelling, *restriction, bound, stop)
                        && self.state.makespan >= bound
                    {
                        return false;
                    }
                }
                Item::Keep(element) => {
                    let served = !element.purposes.is_empty()
                        && element
                            .purposes
                            .iter()
                            .all(|(fact, value)| self.state.holds(*fact, *value));
                    if served {
                        continue;
                    }
                    if let Some(end) = self.append(element.operator) {
                        if end >= bound {
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
                            let free = Restriction::default();
                            self.achieve(element.primary, labelling, free, bound, stop);
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
