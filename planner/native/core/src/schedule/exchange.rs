//! Two objects change places: from some point of the list on, each does what the other one did.
//!
//! Known as 2-opt* for routes of vehicles (Potvin, Rousseau, "An exchange heuristic for routeing problems
//! with time windows", 1995). Single changes hardly ever get there: each of them alone is a detour.

use rand::RngExt;

use crate::pddl::model::ObjectId;
use crate::schedule::changed_list::ChangedList;
use crate::schedule::links::{Element, Role};
use crate::schedule::model::NONE;
use crate::schedule::question::Restriction;
use crate::schedule::workshop::Workshop;
use crate::task::Task;

/// Operators looked at for one that does the same with another object.
const ATTEMPTS: usize = 1_000;

impl Workshop {
    /// Exchanges two objects from an anchor on, mostly to the end.
    pub(super) fn exchange_objects(
        &mut self,
        task: &Task,
        list: &mut ChangedList<'_>,
        anchor: usize,
    ) {
        let elements = list.elements;
        let Some(pair) = self.pair(task, &elements[anchor]) else {
            return self.relocate(list, anchor);
        };
        let end = if self.random.random_bool(0.6) {
            elements.len()
        } else {
            (anchor + self.random.random_range(4..30usize)).min(elements.len())
        };
        for (index, element) in elements.iter().enumerate().take(end).skip(anchor) {
            let arguments = &task.operators[element.operator as usize].arguments;
            if !arguments.contains(&pair.0) && !arguments.contains(&pair.1) {
                continue;
            }
            if element.role == Role::Transit || element.primary == NONE {
                list.dropped[index] = true;
            } else {
                let restriction = self.counterpart(task, element, pair);
                list.redo(index, index, restriction);
            }
        }
    }

    /// An object of the element's operator, and another one in the same place of an operator that
    /// does the same.
    fn pair(&mut self, task: &Task, element: &Element) -> Option<(ObjectId, ObjectId)> {
        let own = &task.operators[element.operator as usize];
        let rules = self.propositions.adding.row(element.primary);
        if rules.is_empty() {
            return None;
        }
        let from = self.random.random_range(0..rules.len());
        for rule in rules[from..].iter().chain(rules).take(ATTEMPTS) {
            let operator = self.propositions.rules[*rule as usize].operator;
            if operator == NONE || task.operators[operator as usize].action != own.action {
                continue;
            }
            let others = &task.operators[operator as usize].arguments;
            let pairs = own.arguments.iter().copied().zip(others.iter().copied());
            let pairs: Vec<(ObjectId, ObjectId)> =
                pairs.filter(|(own, other)| own != other).collect();
            if !pairs.is_empty() {
                return Some(pairs[self.random.random_range(0..pairs.len())]);
            }
        }
        None
    }

    /// How the element's primary is achieved with two objects exchanged.
    fn counterpart(
        &self,
        task: &Task,
        element: &Element,
        (one, other): (ObjectId, ObjectId),
    ) -> Restriction {
        let own = &task.operators[element.operator as usize];
        let exchanged = own.arguments.iter().map(|object| match *object {
            object if object == one => other,
            object if object == other => one,
            object => object,
        });
        let rules = self.propositions.adding.row(element.primary).iter();
        let mut rules = rules.copied().filter(|rule| {
            let operator = self.propositions.rules[*rule as usize].operator;
            operator != NONE && {
                let like = &task.operators[operator as usize];
                like.action == own.action && exchanged.clone().eq(like.arguments.iter().copied())
            }
        });
        let Some(rule) = rules.next() else {
            return Restriction::None;
        };
        // Where a robot comes from is its own affair, if it can be told by where it is then.
        let adds = self
            .propositions
            .adds(&self.propositions.rules[rule as usize]);
        let mut adds = adds.iter().map(|add| add.proposition);
        match adds.find(|add| *add != element.primary) {
            Some(with) => Restriction::With(with),
            None => self.as_operator(rule),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::schedule::changed_list::ChangedList;
    use crate::schedule::question::Restriction;
    use crate::schedule::repair::Item;
    use crate::schedule::testing::{elements, ground_texts, operator};
    use crate::schedule::workshop::Workshop;

    const WORKERS: &str = "(define (domain workers) (:requirements :typing :durative-actions)
     (:types worker job) (:constants w1 w2 - worker j1 j2 j3 j4 - job)
     (:predicates (free ?w - worker) (done ?j - job))
     (:durative-action work :parameters (?w - worker ?j - job) :duration (= ?duration 5)
      :condition (at start (free ?w))
      :effect (and (at start (not (free ?w))) (at end (free ?w)) (at end (done ?j)))))";

    #[test]
    fn both_do_from_there_on_what_the_other_one_did() {
        // Who is free then tells workers apart; where nobody is, only the operator does.
        exchange_from_the_second(WORKERS, |way| matches!(way, Restriction::With(_)));
        let once = WORKERS.replace("(at end (free ?w)) ", "");
        exchange_from_the_second(&once, |way| matches!(way, Restriction::Operator(_)));
    }

    fn exchange_from_the_second(domain: &str, is_told: impl Fn(&Restriction) -> bool) {
        let problem = "(define (problem p) (:domain workers) (:init (free w1) (free w2))
             (:goal (and (done j1) (done j2) (done j3) (done j4))))";
        let task = ground_texts(domain, problem);
        let mut workshop = Workshop::new(&task, 0, None).expect("supported");
        let names = ["work w1 j1", "work w2 j2", "work w2 j3", "work w1 j4"];
        let first = operator(&task, names[0]);
        let elements = elements(&task, &workshop, &names);
        for _ in 0..20 {
            let mut list = ChangedList::new(&elements);
            workshop.exchange_objects(&task, &mut list, 1);
            let items = list.items(&workshop.model);
            assert!(matches!(items[0], Item::Keep(element, _) if element.operator == first));
            let now = ["work w1 j2", "work w1 j3", "work w2 j4"];
            for (item, name) in items[1..].iter().zip(now) {
                let Item::Achieve(proposition, restriction, _) = item else {
                    panic!("{item:?}");
                };
                assert!(is_told(restriction), "{restriction:?}");
                let propositions = &workshop.propositions;
                let ways = propositions.adding.row(*proposition).iter();
                let mut ways = ways.filter(|rule| restriction.admits(propositions, **rule));
                let only = ways
                    .next()
                    .map(|rule| propositions.rules[*rule as usize].operator);
                assert_eq!((only, ways.next()), (Some(operator(&task, name)), None));
            }
            assert_eq!(items.len(), 4);
        }
    }
}
