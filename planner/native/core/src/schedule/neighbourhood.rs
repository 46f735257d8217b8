//! Changed lists: the moves of the large-neighbourhood search.

use rand::RngExt;

use crate::schedule::links::{Element, Role};
use crate::schedule::model::NONE;
use crate::schedule::question::Restriction;
use crate::schedule::repair::Item;
use crate::schedule::workshop::Workshop;
use crate::task::Task;

/// The moves.
const MOVES: usize = 7;

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
            return elements.iter().map(Item::Keep).collect();
        }
        let mut dropped = vec![false; elements.len()];
        // Entries inserted before a position.
        let mut inserted: Vec<(usize, Item<'e>)> = Vec::new();
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
                    inserted.push((position, Item::Achieve(wish, Restriction::default())));
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
        let mut next = inserted.into_iter().peekable();
        for (index, element) in elements.iter().enumerate() {
            while let Some((_, item)) = next.next_if(|(position, _)| *position <= index) {
                items.push(item);
            }
            if !dropped[index] {
                items.push(Item::Keep(element));
            }
        }
        items.extend(next.map(|(_, item)| item));
        items
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

    fn relocate<'e>(
        &mut self,
        elements: &'e [Element],
        anchor: usize,
        dropped: &mut [bool],
        inserted: &mut Vec<(usize, Item<'e>)>,
    ) {
        let position = self.position_near(anchor, elements.len());
        dropped[anchor] = true;
        inserted.push((position, Item::Keep(&elements[anchor])));
    }

    fn swap<'e>(
        &mut self,
        elements: &'e [Element],
        one: usize,
        other: usize,
        dropped: &mut [bool],
        inserted: &mut Vec<(usize, Item<'e>)>,
    ) {
        if one == other {
            return self.relocate(elements, one, dropped, inserted);
        }
        for (from, to) in [(one, other), (other, one)] {
            dropped[from] = true;
            let element = &elements[from];
            let item = if self.random.random_bool(0.5) {
                Item::Keep(element)
            } else {
                let with = self.companion(element);
                Item::Achieve(
                    element.primary,
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

    fn reassign<'e>(
        &mut self,
        elements: &'e [Element],
        anchor: usize,
        dropped: &mut [bool],
        inserted: &mut Vec<(usize, Item<'e>)>,
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
        inserted.push((position, Item::Achieve(element.primary, restriction)));
    }

    fn reinsert<'e>(
        &mut self,
        elements: &'e [Element],
        index: usize,
        dropped: &mut [bool],
        inserted: &mut Vec<(usize, Item<'e>)>,
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
        inserted.push((position, Item::Achieve(element.primary, restriction)));
    }

    /// Takes everything that one object does out of a part of the list.
    fn release_object<'e>(
        &mut self,
        task: &Task,
        elements: &'e [Element],
        anchor: usize,
        dropped: &mut [bool],
        inserted: &mut Vec<(usize, Item<'e>)>,
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

/// Drops what served only dropped operators on the way.
fn drop_feeders(elements: &[Element], dropped: &mut [bool]) {
    for index in (0..elements.len()).rev() {
        let element = &elements[index];
        if !dropped[index]
            && element.role != Role::Goal
            && !element.consumers.is_empty()
            && element
                .consumers
                .iter()
                .all(|consumer| dropped.get(*consumer as usize).copied().unwrap_or(false))
        {
            dropped[index] = true;
        }
    }
}
