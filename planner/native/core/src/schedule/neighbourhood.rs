//! Changed lists: the moves of the large-neighbourhood search.

use rand::RngExt;

use crate::schedule::links::{Element, Role};
use crate::schedule::model::NONE;
use crate::schedule::question::Restriction;
use crate::schedule::repair::{Item, Tail};
use crate::schedule::workshop::Workshop;
use crate::task::Task;

/// The moves.
const MOVES: usize = 7;

/// What a move puts into a list.
#[derive(Clone, Copy, Debug)]
enum Insertion {
    /// Another element of it.
    Element(usize),
    /// What achieves another element's primary.
    Instead(usize, Restriction),
    /// What achieves a proposition.
    Wish(u32),
}

impl Workshop {
    /// A random neighbour of a list.
    pub fn neighbour<'e>(
        &mut self,
        task: &Task,
        elements: &'e [Element],
        persistent: &[u32],
    ) -> Vec<Item<'e>> {
        let anchors: Vec<usize> = (0..elements.len())
            .filter(|index| {
                let element = &elements[*index];
                matches!(element.role, Role::Goal | Role::Lasting) && element.primary != NONE
            })
            .collect();
        if anchors.is_empty() {
            let keep = |element| Item::Keep(element, Tail::default());
            return elements.iter().map(keep).collect();
        }
        let mut dropped = vec![false; elements.len()];
        // Entries inserted before a position.
        let mut inserted: Vec<(usize, Insertion)> = Vec::new();
        let anchor = anchors[self.random.random_range(0..anchors.len())];
        match self.random.random_range(0..MOVES) {
            0 => self.relocate(elements, anchor, &mut dropped, &mut inserted),
            1 => {
                let other = anchors[self.random.random_range(0..anchors.len())];
                self.swap(elements, anchor, other, &mut dropped, &mut inserted);
            }
            2 => self.reassign(elements, anchor, &mut dropped, &mut inserted),
            3 => {
                let count = self.random.random_range(1..=3usize);
                for _ in 0..count {
                    let index = anchors[self.random.random_range(0..anchors.len())];
                    self.reinsert(elements, index, &mut dropped, &mut inserted);
                }
            }
            4 => {
                let width = self.random.random_range(2..=4usize);
                let first = anchors
                    .iter()
                    .position(|index| *index == anchor)
                    .unwrap_or(0);
                for index in anchors.iter().skip(first).take(width) {
                    self.reinsert(elements, *index, &mut dropped, &mut inserted);
                }
            }
            5 => self.release_object(task, elements, anchor, &mut dropped, &mut inserted),
            _ => {
                if !persistent.is_empty() {
                    let wish = persistent[self.random.random_range(0..persistent.len())];
                    let position = self.random.random_range(0..=anchor);
                    inserted.push((position, Insertion::Wish(wish)));
                }
                self.reinsert(elements, anchor, &mut dropped, &mut inserted);
                if self.random.random_bool(0.5) {
                    let index = anchors[self.random.random_range(0..anchors.len())];
                    self.reinsert(elements, index, &mut dropped, &mut inserted);
                }
            }
        }
        drop_feeders(elements, &mut dropped);
        inserted.sort_by_key(|(position, _)| *position);
        let mut items = Vec::with_capacity(elements.len() + inserted.len());
        let spans = self.spans(elements, &dropped);
        let item = |(position, insertion): (usize, Insertion)| match insertion {
            Insertion::Wish(wish) => Item::Achieve(wish, Restriction::default(), 0.0),
            Insertion::Element(index) => {
                let element = &elements[index];
                Item::Keep(element, tail(element, &spans, position))
            }
            Insertion::Instead(index, restriction) => {
                let element = &elements[index];
                let tail = tail(element, &spans, position);
                Item::Achieve(element.primary, restriction, tail.primary)
            }
        };
        let mut next = inserted.into_iter().peekable();
        for (index, element) in elements.iter().enumerate() {
            while let Some(insertion) = next.next_if(|(position, _)| *position <= index) {
                items.push(item(insertion));
            }
            if !dropped[index] {
                items.push(Item::Keep(element, tail(element, &spans, index)));
            }
        }
        items.extend(next.map(item));
        items
    }

    /// How long it takes, from the start of each element that is not dropped, until all is over that
    /// waits for it [s].
    fn spans(&self, elements: &[Element], dropped: &[bool]) -> Vec<f64> {
        let mut spans = vec![0.0; elements.len()];
        for (index, element) in elements.iter().enumerate().rev() {
            if !dropped[index] {
                // Unknown durations are not a number.
                let duration = self.model.shapes[element.operator as usize].duration;
                spans[index] = duration.max(0.0) + tail(element, &spans, index).any;
            }
        }
        spans
    }

    fn position_near(&mut self, index: usize, count: usize) -> usize {
        if self.random.random_bool(0.5) {
            let reach = 8.min(count);
            let low = index.saturating_sub(reach);
            self.random.random_range(low..=(index + reach).min(count))
        } else {
            self.random.random_range(0..=count)
        }
    }

    fn relocate(
        &mut self,
        elements: &[Element],
        anchor: usize,
        dropped: &mut [bool],
        inserted: &mut Vec<(usize, Insertion)>,
    ) {
        let position = self.position_near(anchor, elements.len());
        dropped[anchor] = true;
        inserted.push((position, Insertion::Element(anchor)));
    }

    fn swap(
        &mut self,
        elements: &[Element],
        one: usize,
        other: usize,
        dropped: &mut [bool],
        inserted: &mut Vec<(usize, Insertion)>,
    ) {
        if one == other {
            return self.relocate(elements, one, dropped, inserted);
        }
        for (from, to) in [(one, other), (other, one)] {
            dropped[from] = true;
            let element = &elements[from];
            let item = if self.random.random_bool(0.5) {
                Insertion::Element(from)
            } else {
                let with = self.companion(element);
                Insertion::Instead(
                    from,
                    Restriction {
                        with: with.filter(|_| self.random.random_bool(0.5)),
                    },
                )
            };
            inserted.push((to, item));
        }
    }

    /// What another way to the element's primary adds besides: `at r t` of the robot r that
    /// explores t instead.
    fn companion(&mut self, element: &Element) -> Option<u32> {
        let rules = self.propositions.adding.row(element.primary);
        if rules.is_empty() {
            return None;
        }
        let rule = rules[self.random.random_range(0..rules.len())];
        let rule = &self.propositions.rules[rule as usize];
        let adds = self.propositions.adds(rule);
        let others = adds.iter().filter(|add| add.proposition != element.primary);
        let others: Vec<u32> = others.map(|add| add.proposition).collect();
        (!others.is_empty()).then(|| others[self.random.random_range(0..others.len())])
    }

    fn reassign(
        &mut self,
        elements: &[Element],
        anchor: usize,
        dropped: &mut [bool],
        inserted: &mut Vec<(usize, Insertion)>,
    ) {
        dropped[anchor] = true;
        let element = &elements[anchor];
        let restriction = match self.companion(element) {
            Some(with) => Restriction { with: Some(with) },
            None => Restriction::default(),
        };
        let position = if self.random.random_bool(0.5) {
            anchor
        } else {
            self.position_near(anchor, elements.len())
        };
        inserted.push((position, Insertion::Instead(anchor, restriction)));
    }

    fn reinsert(
        &mut self,
        elements: &[Element],
        index: usize,
        dropped: &mut [bool],
        inserted: &mut Vec<(usize, Insertion)>,
    ) {
        if dropped[index] {
            return;
        }
        dropped[index] = true;
        let element = &elements[index];
        if element.primary == NONE {
            return;
        }
        // What no goal needs may stay away; whoever misses it achieves it.
        if element.role == Role::Lasting && self.random.random_bool(0.6) {
            return;
        }
        let position = self.position_near(index, elements.len());
        let with = if self.random.random_bool(0.4) {
            self.companion(element)
        } else {
            None
        };
        let restriction = Restriction { with };
        inserted.push((position, Insertion::Instead(index, restriction)));
    }

    /// Takes everything that one object does out of a part of the list.
    fn release_object(
        &mut self,
        task: &Task,
        elements: &[Element],
        anchor: usize,
        dropped: &mut [bool],
        inserted: &mut Vec<(usize, Insertion)>,
    ) {
        let arguments = &task.operators[elements[anchor].operator as usize].arguments;
        if arguments.is_empty() {
            return self.relocate(elements, anchor, dropped, inserted);
        }
        let object = arguments[self.random.random_range(0..arguments.len())];
        let limit = self.random.random_range(1..=8usize);
        let from = if self.random.random_bool(0.5) {
            anchor
        } else {
            0
        };
        let mut count = 0;
        for (index, element) in elements.iter().enumerate().skip(from) {
            let operator = &task.operators[element.operator as usize];
            if count < limit && operator.arguments.contains(&object) {
                count += 1;
                if element.role == Role::Transit {
                    dropped[index] = true;
                } else {
                    self.reinsert(elements, index, dropped, inserted);
                }
            }
        }
    }
}

/// How long it takes from the end of an element on: those that take what it achieves, at a position or
/// behind it, cannot start before.
fn tail(element: &Element, spans: &[f64], position: usize) -> Tail {
    let mut tail = Tail::default();
    for consumer in &element.consumers {
        let index = consumer.position as usize;
        if consumer.follows && index >= position {
            tail.any = tail.any.max(spans[index]);
            if consumer.proposition == element.primary {
                tail.primary = tail.primary.max(spans[index]);
            }
        }
    }
    tail
}

/// Drops what served only dropped operators on the way.
fn drop_feeders(elements: &[Element], dropped: &mut [bool]) {
    for index in (0..elements.len()).rev() {
        let element = &elements[index];
        if !dropped[index]
            && element.role != Role::Goal
            && !element.consumers.is_empty()
            && element.consumers.iter().all(|consumer| {
                dropped
                    .get(consumer.position as usize)
                    .copied()
                    .unwrap_or(false)
            })
        {
            dropped[index] = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::schedule::links::{Element, Links};
    use crate::schedule::testing::{FACTORY, task};
    use crate::schedule::workshop::Workshop;
    use crate::task::{OperatorId, Task};

    fn elements(task: &Task, workshop: &Workshop, names: &[&str]) -> Vec<Element> {
        let named = |name: &str| {
            let mut operators = 0..task.operators.len() as u32;
            let found = operators.find(|index| task.operator_name(OperatorId(*index)) == name);
            found.unwrap_or_else(|| panic!("no operator {name}"))
        };
        let operators: Vec<u32> = names.iter().map(|name| named(name)).collect();
        let (model, propositions) = (&workshop.model, &workshop.propositions);
        Links::default().elements(model, propositions, &operators, true)
    }

    #[test]
    fn spans_reach_as_far_as_consumers_cannot_start_before() {
        let task = task(FACTORY);
        let workshop = Workshop::new(&task, 0, None).expect("supported");
        let list = elements(&task, &workshop, &["prime", "paint", "pack", "sweep"]);
        // It is painted from the start of painting on: packing need not wait for the end.
        assert_eq!(workshop.spans(&list, &[false; 4]), [7.0, 3.0, 2.0, 1.0]);
        let without_paint = [false, true, false, false];
        assert_eq!(workshop.spans(&list, &without_paint), [4.0, 0.0, 2.0, 1.0]);
    }

    #[test]
    fn a_tail_is_of_those_behind_the_place_and_of_the_primary_apart() {
        let domain = FACTORY.replace("(at end (primed))", "(at end (primed)) (at end (warm))");
        let domain = domain
            .replace("(primed) (painted)", "(primed) (warm) (painted)")
            .replace(
                "(at start (dusty)) \n",
                "(and (at start (dusty)) (at start (warm)))\n",
            );
        let task = task(&domain);
        let workshop = Workshop::new(&task, 0, None).expect("supported");
        let list = elements(&task, &workshop, &["prime", "sweep", "paint", "pack"]);
        let spans = workshop.spans(&list, &[false; 4]);
        let tail = |position: usize| super::tail(&list[0], &spans, position);
        assert_eq!(tail(0).any, 3.0);
        assert_eq!(tail(3).any, 0.0);
        let primary = list[0].primary;
        let warms = primary == list[0].consumers[1].proposition;
        assert_eq!(tail(0).primary, if warms { 1.0 } else { 3.0 });
    }
}
