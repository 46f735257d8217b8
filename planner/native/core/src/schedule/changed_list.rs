//! A list being changed: what is taken out of it and what is put in.

use crate::schedule::links::{Element, Role};
use crate::schedule::model::Model;
use crate::schedule::question::Restriction;
use crate::schedule::repair::{Item, Tail};

/// What is put into a list.
#[derive(Clone, Copy, Debug)]
pub(super) enum Insertion {
    /// Another element of it.
    Element(usize),
    /// What achieves another element's primary.
    Instead(usize, Restriction),
    /// What achieves a proposition.
    Wish(u32),
    /// That a proposition is not to be achieved from there on.
    Without(u32),
}

/// A list and its changes so far.
#[derive(Clone, Debug)]
pub(super) struct ChangedList<'e> {
    pub elements: &'e [Element],
    pub dropped: Vec<bool>,
    /// What is put in before a position.
    inserted: Vec<(usize, Insertion)>,
}

impl<'e> ChangedList<'e> {
    pub fn new(elements: &'e [Element]) -> Self {
        Self {
            elements,
            dropped: vec![false; elements.len()],
            inserted: Vec::new(),
        }
    }

    /// The elements that moves start from.
    pub fn anchors(&self) -> Vec<usize> {
        (0..self.elements.len())
            .filter(|index| self.elements[*index].is_anchor())
            .collect()
    }

    pub fn insert(&mut self, position: usize, insertion: Insertion) {
        self.inserted.push((position, insertion));
    }

    /// Takes an element out; what it achieves is achieved anew before a position.
    pub fn redo(&mut self, index: usize, position: usize, restriction: Restriction) {
        self.dropped[index] = true;
        self.insert(position, Insertion::Instead(index, restriction));
    }

    /// Drops what served only dropped operators on the way.
    fn drop_feeders(&mut self) {
        for index in (0..self.elements.len()).rev() {
            let element = &self.elements[index];
            let is_dropped = |position: u32| self.dropped.get(position as usize) == Some(&true);
            let mut consumers = element.consumers.iter();
            if element.role != Role::Goal
                && !element.consumers.is_empty()
                && consumers.all(|consumer| is_dropped(consumer.position))
            {
                self.dropped[index] = true;
            }
        }
    }

    /// How long it takes, from the start of each element that is not dropped, until all is over that
    /// waits for it [s].
    fn spans(&self, model: &Model) -> Vec<f64> {
        let mut spans = vec![0.0; self.elements.len()];
        for (index, element) in self.elements.iter().enumerate().rev() {
            if !self.dropped[index] {
                // Unknown durations are not a number.
                let duration = model.shapes[element.operator as usize].duration;
                spans[index] = duration.max(0.0) + tail(element, &spans, index).any;
            }
        }
        spans
    }

    /// What to execute.
    pub fn items(mut self, model: &Model) -> Vec<Item<'e>> {
        self.drop_feeders();
        let spans = self.spans(model);
        self.inserted.sort_by_key(|(position, _)| *position);
        let mut items = Vec::with_capacity(self.elements.len() + self.inserted.len());
        let elements = self.elements;
        let item = |(position, insertion): (usize, Insertion)| match insertion {
            Insertion::Wish(wish) => Item::Achieve(wish, Restriction::None, 0.0),
            Insertion::Without(proposition) => Item::Without(proposition),
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
        let mut next = self.inserted.into_iter().peekable();
        for (index, element) in elements.iter().enumerate() {
            while let Some(insertion) = next.next_if(|(position, _)| *position <= index) {
                items.push(item(insertion));
            }
            if !self.dropped[index] {
                items.push(Item::Keep(element, tail(element, &spans, index)));
            }
        }
        items.extend(next.map(item));
        items
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

#[cfg(test)]
mod tests {
    use super::{ChangedList, Insertion};
    use crate::schedule::repair::Item;
    use crate::schedule::testing::{FACTORY, elements, operator, task};
    use crate::schedule::workshop::Workshop;

    #[test]
    fn spans_reach_as_far_as_consumers_cannot_start_before() {
        let task = task(FACTORY);
        let workshop = Workshop::new(&task, 0, None).expect("supported");
        let list = elements(&task, &workshop, &["prime", "paint", "pack", "sweep"]);
        let mut changed = ChangedList::new(&list);
        // It is painted from the start of painting on: packing need not wait for the end.
        assert_eq!(changed.spans(&workshop.model), [7.0, 3.0, 2.0, 1.0]);
        changed.dropped[1] = true;
        assert_eq!(changed.spans(&workshop.model), [4.0, 0.0, 2.0, 1.0]);
    }

    #[test]
    fn a_tail_is_of_those_behind_the_place_and_of_the_primary_apart() {
        let domain = FACTORY
            .replace("(at end (primed))", "(at end (primed)) (at end (warm))")
            .replace("(primed) (painted)", "(primed) (warm) (painted)")
            .replace(
                "(at start (dusty)) \n",
                "(and (at start (dusty)) (at start (warm)))\n",
            );
        let task = task(&domain);
        let workshop = Workshop::new(&task, 0, None).expect("supported");
        let list = elements(&task, &workshop, &["prime", "paint", "pack", "sweep"]);
        let spans = ChangedList::new(&list).spans(&workshop.model);
        let tail = |position: usize| super::tail(&list[0], &spans, position);
        // The primary is what the last one takes: sweeping the warmth.
        assert_eq!((tail(0).any, tail(0).primary), (3.0, 1.0));
        assert_eq!((tail(2).any, tail(2).primary), (1.0, 1.0));
        assert_eq!(tail(4).any, 0.0);
    }

    #[test]
    fn what_serves_only_what_is_dropped_is_dropped_too() {
        let task = task(FACTORY);
        let workshop = Workshop::new(&task, 0, None).expect("supported");
        let list = elements(&task, &workshop, &["prime", "paint", "pack", "sweep"]);
        let mut changed = ChangedList::new(&list);
        changed.dropped[1] = true;
        changed.insert(3, Insertion::Element(1));
        changed.insert(1, Insertion::Without(list[0].primary));
        let items = changed.items(&workshop.model);
        let kept = |item: &Item| match item {
            Item::Keep(element, _) => element.operator,
            _ => u32::MAX,
        };
        let operators: Vec<u32> = items.iter().map(kept).collect();
        let of = |name: &str| operator(&task, name);
        assert_eq!(operators, [u32::MAX, of("pack"), of("paint"), of("sweep")]);
    }
}
