//! One cycle of local search: simulated annealing, then iterated local search.
//!
//! A change that leads away from a local optimum mostly makes something else late, and annealing would
//! have to accept all of that at once. So every change is followed by a short descent that starts from
//! what is late now (iterated local search, Lourenço, Martin, Stützle 2003; moves on the critical path,
//! Nowicki, Smutnicki, "A fast taboo search algorithm for the job shop problem", 1996), and only where
//! that leads to is accepted or not.

use rand::RngExt;

use crate::schedule::critical::critical_anchors;
use crate::schedule::cycle::Cycle;
use crate::schedule::limits::Limits;
use crate::schedule::links::Element;
use crate::schedule::optimiser::Optimiser;
use crate::schedule::solution::Schedule;

/// The part of a cycle that is annealing.
const ANNEALING: f64 = 0.25;
/// Temperatures of annealing, relative to the value of the list that it begins with.
const HOT: f64 = 0.02;
const COLD: f64 = 0.001;
/// Temperatures at which changes with their descents are accepted, relative to the current value.
const WARM: f64 = 0.012;
const COOL: f64 = 0.001;
/// How much worse a change may make a list before its descent, as a part of its value.
const SLACK: f64 = 0.2;
/// Lists without success after which a descent ends.
const PATIENCE: u32 = 40;
/// Cycles of fewer lists for each operator of the one they begin with are annealing throughout: a
/// descent takes some dozens, and more where there is more to change.
const MANY: u64 = 20;
/// How often a descent changes something that the makespan waits for.
const FOCUS: f64 = 0.8;

/// A list of operators and what its schedule is worth.
#[derive(Clone, Debug)]
pub(super) struct Current {
    pub elements: Vec<Element>,
    pub value: f64,
}

impl Optimiser<'_> {
    /// One cycle, from a list on. Each better plan is reported; returns what the last list is worth.
    pub(super) fn search_from(
        &mut self,
        mut current: Current,
        cycle: Cycle,
        limits: &Limits<'_>,
        on_plan: &mut dyn FnMut(&Schedule),
    ) -> f64 {
        // Without times to be late for, there is nothing to descend from; short cycles have no time to.
        let is_time = self.workshop.objective.is_time();
        let descends = is_time && cycle.lists >= MANY * current.elements.len() as u64;
        let annealing = if descends { ANNEALING } else { 1.0 };
        let scale = current.value.abs().max(1e-3);
        let begun = self.nodes;
        loop {
            let progress = cycle.progress(self.nodes - begun);
            if progress >= 1.0 || self.proved() || limits.reached() {
                return current.value;
            }
            let next = if progress < annealing {
                let temperature = scale * between(HOT, COLD, progress / annealing);
                let accepted = self.accepted(current.value, temperature);
                // The value is never below the makespan: stop schedules that end too late.
                let bound = if is_time { accepted } else { f64::INFINITY };
                self.change(&current, &[], bound, limits)
                    .filter(|next| next.value <= accepted)
            } else {
                let progress = (progress - annealing) / (1.0 - annealing);
                let temperature = current.value * between(WARM, COOL, progress);
                let accepted = self.accepted(current.value, temperature);
                let over = |nodes: u64| cycle.progress(nodes - begun) >= 1.0;
                self.change_and_descend(&current, accepted, limits, &over)
            };
            if let Some(next) = next {
                current = next;
                self.offer(&current.elements, on_plan);
            }
        }
    }

    /// The worst value that is accepted this time (Kirkpatrick, Gelatt, Vecchi 1983).
    fn accepted(&mut self, value: f64, temperature: f64) -> f64 {
        let luck: f64 = self.workshop.random.random();
        value - temperature * luck.max(1e-12).ln()
    }

    /// A random neighbour of a list, changed at one of some anchors if any are given; its schedule is
    /// the one under construction. `None` if it ends at the bound or later, cannot be executed or is
    /// the same.
    fn change(
        &mut self,
        current: &Current,
        focus: &[usize],
        bound: f64,
        limits: &Limits<'_>,
    ) -> Option<Current> {
        self.nodes += 1;
        let Current { elements, value } = current;
        let labelling = self.workshop.labelling();
        let items = self
            .workshop
            .neighbour(self.task, elements, &self.persistent, focus);
        let stop = || limits.reached();
        if !self.workshop.repair(&items, labelling, bound, &stop)
            || self.workshop.is_again(elements, *value)
        {
            return None;
        }
        let elements = self.workshop.prune(&mut self.links);
        let value = self.workshop.value();
        Some(Current { elements, value })
    }

    /// A random neighbour, or what a descent from it leads to; `None` if that is not accepted, or if the
    /// cycle is over.
    fn change_and_descend(
        &mut self,
        current: &Current,
        accepted: f64,
        limits: &Limits<'_>,
        over: &dyn Fn(u64) -> bool,
    ) -> Option<Current> {
        let bound = accepted.max(current.value * (1.0 + SLACK));
        let mut next = self.change(current, &[], bound, limits)?;
        let mut anchors = None;
        let mut failures = 0;
        while next.value > accepted {
            if failures == PATIENCE || over(self.nodes) || limits.reached() {
                return None;
            }
            let late = anchors
                .get_or_insert_with(|| critical_anchors(&next.elements, &self.workshop.state));
            let focused = self.workshop.random.random_bool(FOCUS);
            let focus = if focused { late.as_slice() } else { &[] };
            match self.change(&next, focus, next.value, limits) {
                Some(better) if better.value < next.value - 1e-6 => {
                    next = better;
                    failures = 0;
                    anchors = None;
                }
                _ => failures += 1,
            }
        }
        Some(next)
    }
}

/// From one temperature to the other, geometrically.
fn between(first: f64, last: f64, progress: f64) -> f64 {
    first * (last / first).powf(progress)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::Current;
    use crate::schedule::cycle::Cycle;
    use crate::schedule::limits::Limits;
    use crate::schedule::optimiser::Optimiser;
    use crate::schedule::testing::{ground_texts, operator};
    use crate::task::Task;

    /// Jobs of 3, 3, 2, 2 and 2 seconds for two workers: 6 s if one does the long ones.
    fn jobs() -> Task {
        let domain = "(define (domain workers)
             (:requirements :typing :durative-actions :numeric-fluents)
             (:types worker job) (:predicates (free ?w - worker) (done ?j - job))
             (:functions (length ?j - job))
             (:durative-action work :parameters (?w - worker ?j - job)
              :duration (= ?duration (length ?j)) :condition (at start (free ?w))
              :effect (and (at start (not (free ?w))) (at end (free ?w)) (at end (done ?j)))))";
        let problem = "(define (problem p) (:domain workers)
             (:objects w1 w2 - worker a b c d e - job)
             (:init (free w1) (free w2) (= (length a) 3) (= (length b) 3) (= (length c) 2)
              (= (length d) 2) (= (length e) 2))
             (:goal (and (done a) (done b) (done c) (done d) (done e))))";
        ground_texts(domain, problem)
    }

    fn unlimited(cancel: &AtomicBool) -> Limits<'_> {
        Limits {
            deadline: None,
            patience: None,
            cancel,
            nodes: None,
        }
    }

    /// Longest jobs first: 7 s.
    fn longest_first(task: &Task, optimiser: &mut Optimiser<'_>) -> Current {
        let names = [
            "work w1 a",
            "work w2 b",
            "work w1 c",
            "work w2 d",
            "work w1 e",
        ];
        let list = names.map(|name| operator(task, name));
        assert!(optimiser.workshop.replay(list.into_iter()));
        let elements = optimiser.workshop.prune(&mut optimiser.links);
        let value = optimiser.workshop.value();
        Current { elements, value }
    }

    #[test]
    fn a_change_is_taken_for_what_its_descent_leads_to() {
        let task = jobs();
        let mut optimiser = Optimiser::new(&task, 1, None).expect("supported");
        let start = longest_first(&task, &mut optimiser);
        assert!((start.value - 7.0).abs() < 0.5, "{}", start.value);
        let cancel = AtomicBool::new(false);
        let limits = unlimited(&cancel);
        let accepted = start.value - 0.5;
        let mut taken = 0;
        for _ in 0..50 {
            let next = optimiser.change_and_descend(&start, accepted, &limits, &|_| false);
            if let Some(next) = next {
                taken += 1;
                assert!(next.value <= accepted);
                let operators = next.elements.iter().map(|element| element.operator);
                assert!(optimiser.workshop.replay(operators) && optimiser.workshop.goal_holds());
                assert!((optimiser.workshop.value() - next.value).abs() < 1e-9);
                assert!(optimiser.workshop.state.makespan < 6.1);
            }
        }
        assert!(taken > 10, "{taken} of 50");
    }

    #[test]
    fn a_descent_ends_with_its_cycle() {
        let task = jobs();
        let mut optimiser = Optimiser::new(&task, 1, None).expect("supported");
        let start = longest_first(&task, &mut optimiser);
        let cancel = AtomicBool::new(false);
        let limits = unlimited(&cancel);
        for length in [1, 333, 500, 777] {
            let before = optimiser.nodes;
            optimiser.best = None;
            let cycle = Cycle::of(length);
            let value = optimiser.search_from(start.clone(), cycle, &limits, &mut |_| {});
            assert_eq!(optimiser.nodes - before, length);
            assert!(value <= start.value * 1.1);
        }
    }
}
