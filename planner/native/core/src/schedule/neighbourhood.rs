//! Changed lists: the moves of the large-neighbourhood search.

use rand::RngExt;

use crate::schedule::changed_list::{ChangedList, Insertion};
use crate::schedule::links::{Element, Role};
use crate::schedule::model::NONE;
use crate::schedule::question::Restriction;
use crate::schedule::repair::Item;
use crate::schedule::workshop::Workshop;
use crate::task::Task;

/// The moves.
const MOVES: usize = 9;

impl Workshop {
    /// A random neighbour of a list, changed at one of some anchors, if any are given.
    pub fn neighbour<'e>(
        &mut self,
        task: &Task,
        elements: &'e [Element],
        persistent: &[u32],
        focus: &[usize],
    ) -> Vec<Item<'e>> {
        let mut list = ChangedList::new(elements);
        let anchors = list.anchors();
        if anchors.is_empty() {
            return list.items(&self.model);
        }
        let choice = if focus.is_empty() { &anchors } else { focus };
        let anchor = choice[self.random.random_range(0..choice.len())];
        match self.random.random_range(0..MOVES) {
            0 => self.relocate(&mut list, anchor),
            1 => {
                let other = anchors[self.random.random_range(0..anchors.len())];
                self.swap(&mut list, anchor, other);
            }
            2 => self.reassign(&mut list, anchor),
            3 => {
                let count = self.random.random_range(1..=3usize);
                for _ in 0..count {
                    let index = anchors[self.random.random_range(0..anchors.len())];
                    self.reinsert(&mut list, index);
                }
            }
            4 => {
                let width = self.random.random_range(2..=4usize);
                let first = anchors
                    .iter()
                    .position(|index| *index == anchor)
                    .unwrap_or(0);
                for index in anchors.iter().skip(first).take(width) {
                    self.reinsert(&mut list, *index);
                }
            }
            5 => self.release_object(task, &mut list, anchor),
            6 => self.exchange_objects(task, &mut list, anchor),
            7 => self.do_without(&mut list, &anchors, anchor),
            _ => {
                if !persistent.is_empty() {
                    let wish = persistent[self.random.random_range(0..persistent.len())];
                    let position = self.random.random_range(0..=anchor);
                    list.insert(position, Insertion::Wish(wish));
                }
                self.reinsert(&mut list, anchor);
                if self.random.random_bool(0.5) {
                    let index = anchors[self.random.random_range(0..anchors.len())];
                    self.reinsert(&mut list, index);
                }
            }
        }
        list.items(&self.model)
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

    pub(super) fn relocate(&mut self, list: &mut ChangedList<'_>, anchor: usize) {
        let position = self.position_near(anchor, list.elements.len());
        list.dropped[anchor] = true;
        list.insert(position, Insertion::Element(anchor));
    }

    fn swap(&mut self, list: &mut ChangedList<'_>, one: usize, other: usize) {
        if one == other {
            return self.relocate(list, one);
        }
        for (from, to) in [(one, other), (other, one)] {
            if self.random.random_bool(0.5) {
                list.dropped[from] = true;
                list.insert(to, Insertion::Element(from));
            } else {
                let restriction = self.another_way(&list.elements[from], 0.5);
                list.redo(from, to, restriction);
            }
        }
    }

    /// What a random way to the element's primary looks like, or, with the rest of the probability,
    /// none in particular. `at r t` tells apart the robot r that explores t.
    fn another_way(&mut self, element: &Element, probability: f64) -> Restriction {
        let rules = self.propositions.adding.row(element.primary);
        if rules.is_empty() || !self.random.random_bool(probability) {
            return Restriction::None;
        }
        let rule = rules[self.random.random_range(0..rules.len())];
        let adds = self
            .propositions
            .adds(&self.propositions.rules[rule as usize]);
        let others = adds.iter().map(|add| add.proposition);
        let others: Vec<u32> = others.filter(|add| *add != element.primary).collect();
        if others.is_empty() {
            return self.as_operator(rule);
        }
        Restriction::With(others[self.random.random_range(0..others.len())])
    }

    /// By the operator of a rule, if it is one's.
    pub(super) fn as_operator(&self, rule: u32) -> Restriction {
        match self.propositions.rules[rule as usize].operator {
            NONE => Restriction::None,
            operator => Restriction::Operator(operator),
        }
    }

    fn reassign(&mut self, list: &mut ChangedList<'_>, anchor: usize) {
        let restriction = self.another_way(&list.elements[anchor], 1.0);
        let position = if self.random.random_bool(0.5) {
            anchor
        } else {
            self.position_near(anchor, list.elements.len())
        };
        list.redo(anchor, position, restriction);
    }

    fn reinsert(&mut self, list: &mut ChangedList<'_>, index: usize) {
        if list.dropped[index] {
            return;
        }
        list.dropped[index] = true;
        let element = &list.elements[index];
        if element.primary == NONE {
            return;
        }
        // What no goal needs may stay away; whoever misses it achieves it.
        if element.role == Role::Lasting && self.random.random_bool(0.6) {
            return;
        }
        let position = self.position_near(index, list.elements.len());
        let restriction = self.another_way(element, 0.4);
        list.redo(index, position, restriction);
    }

    /// Takes everything that one object does out of a part of the list.
    fn release_object(&mut self, task: &Task, list: &mut ChangedList<'_>, anchor: usize) {
        let elements = list.elements;
        let arguments = &task.operators[elements[anchor].operator as usize].arguments;
        if arguments.is_empty() {
            return self.relocate(list, anchor);
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
                    list.dropped[index] = true;
                } else {
                    self.reinsert(list, index);
                }
            }
        }
    }

    /// Goes without something that lasts and is no goal: those that took it look for other ways.
    fn do_without(&mut self, list: &mut ChangedList<'_>, anchors: &[usize], anchor: usize) {
        let elements = list.elements;
        let lasting = |index: &&usize| elements[**index].role == Role::Lasting;
        let lasting: Vec<usize> = anchors.iter().filter(lasting).copied().collect();
        if lasting.is_empty() {
            return self.relocate(list, anchor);
        }
        let index = lasting[self.random.random_range(0..lasting.len())];
        let element = &elements[index];
        list.dropped[index] = true;
        list.insert(index, Insertion::Without(element.primary));
        for consumer in &element.consumers {
            let position = consumer.position as usize;
            if position < elements.len() && !list.dropped[position] {
                if elements[position].is_anchor() {
                    list.redo(position, position, Restriction::None);
                } else {
                    list.dropped[position] = true;
                }
            }
        }
    }
}
