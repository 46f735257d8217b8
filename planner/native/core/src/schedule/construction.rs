//! Plans from nothing: the goals one after the other, each by its relaxed plan.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rand::RngExt;
use rand::seq::SliceRandom;

use crate::schedule::model::NONE;
use crate::schedule::question::{Labelling, Restriction};
use crate::schedule::workshop::Workshop;

/// Rounds over the goals: achieving one may destroy another.
const ROUNDS: u32 = 6;

/// Weight of distances where a list has to be finished soon.
const HASTY_GREED: f32 = 3.0;

/// How a list is made from nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manner {
    /// The goals as they can be reached.
    Thorough,
    /// The goals by their bounds, and the first way to each that is found: for tasks so large that
    /// the thorough list takes seconds.
    Hasty,
    /// One of both, at random.
    Any,
}

impl Workshop {
    /// Achieves every goal that does not hold, in the given order; goals that later ones destroy
    /// are achieved again. `stop` is asked between goals.
    pub fn achieve_goals(
        &mut self,
        order: &mut [u32],
        labelling: Labelling,
        bound: f64,
        stop: &dyn Fn() -> bool,
    ) -> bool {
        for _ in 0..ROUNDS {
            let mut open = false;
            let mut progress = false;
            for goal in order.iter() {
                if self.holds(*goal) {
                    continue;
                }
                open = true;
                if stop() {
                    return false;
                }
                let mark = self.state.mark();
                if self.achieve(*goal, labelling, Restriction::None, bound, stop) {
                    progress = true;
                } else {
                    self.state.rollback(mark);
                    if labelling.without == NONE {
                        self.failed(*goal);
                    }
                    if self.late {
                        return false;
                    }
                }
                if self.state.list.len() > self.longest {
                    return false;
                }
            }
            if !open {
                return true;
            }
            if !progress {
                return false;
            }
            // Goals that hold stay in front: what destroys others should come early.
            let (state, propositions) = (&self.state, &self.propositions);
            order.sort_by_key(|goal| propositions.holds(state, *goal));
        }
        self.goal_holds()
    }

    /// Achieves the goals in the order in which they can be achieved: always the one next that the
    /// schedule so far reaches first. What is left over is achieved in any order.
    ///
    /// A longer schedule hardly ever makes a goal come earlier, so the labels of before are taken for
    /// lower bounds, and only the least one is computed anew (lazy greedy; Minoux, "Accelerated
    /// greedy algorithms", 1978).
    fn achieve_earliest_first(
        &mut self,
        labelling: Labelling,
        bound: f64,
        stop: &dyn Fn() -> bool,
    ) -> bool {
        let mut waiting = BinaryHeap::new();
        let mut left = Vec::new();
        for goal in self.propositions.goal.clone() {
            waiting.push(Reverse((0, goal)));
        }
        while let Some(Reverse((_, goal))) = waiting.pop() {
            if self.holds(goal) {
                continue;
            }
            if stop() {
                return false;
            }
            let label = self.label(goal, labelling, stop);
            // Non-negative floats are ordered like their bits.
            let key = label.max(0.0).to_bits();
            if label.is_finite()
                && waiting
                    .peek()
                    .is_some_and(|Reverse((least, _))| *least < key)
            {
                waiting.push(Reverse((key, goal)));
                continue;
            }
            let mark = self.state.mark();
            if !label.is_finite() || !self.achieve(goal, labelling, Restriction::None, bound, stop)
            {
                if self.late {
                    return false;
                }
                self.state.rollback(mark);
                left.push(goal);
            }
            if self.state.list.len() > self.longest {
                return false;
            }
        }
        if self.goal_holds() {
            return true;
        }
        // Goals that hold stay in front: what destroys others should come early.
        let mut order = self.propositions.goal.clone();
        order.sort_by_key(|goal| left.contains(goal));
        self.achieve_goals(&mut order, labelling, bound, stop)
    }

    /// Remembers that a goal could not be achieved where it stood: it moves forward next time
    /// (squeaky wheel optimisation; Joslin and Clements, JAIR 10, 1999).
    fn failed(&mut self, goal: u32) {
        if let Some(index) = self
            .propositions
            .goal
            .iter()
            .position(|other| *other == goal)
        {
            self.urgency[index] += 1.0;
        }
    }

    /// Puts goals that failed before first, and near ones before far ones.
    fn sort_by_urgency(&mut self, order: &mut [u32]) {
        let scale = self.reach.iter().copied().filter(|reach| reach.is_finite());
        let scale = scale.fold(1.0, f64::max);
        let spread = [0.02, 0.2, 0.6][self.random.random_range(0..3)];
        let mut rank = rustc_hash::FxHashMap::default();
        for (index, goal) in self.propositions.goal.iter().enumerate() {
            let noise: f64 = self.random.random();
            let weight = self.reach[index] / scale - self.urgency[index] * 0.15 + spread * noise;
            rank.insert(*goal, weight);
        }
        order.sort_by(|left, right| rank[left].total_cmp(&rank[right]));
    }

    /// One plan from nothing.
    pub fn construct(&mut self, manner: Manner, bound: f64, stop: &dyn Fn() -> bool) -> bool {
        self.reset();
        let mut order = self.propositions.goal.clone();
        let mut labelling = self.labelling();
        if manner != Manner::Any {
            labelling.effort = if self.objective.is_time() { 0.05 } else { 1.0 };
            labelling.noise = 0.05;
            labelling.protect = true;
        }
        if manner == Manner::Any && self.urgency.iter().any(|failures| *failures > 0.0) {
            // Goals that fail may do so because the nearest need of a step is achieved first.
            labelling.far_first = labelling.salt & 1 == 1;
        }
        if manner == Manner::Hasty {
            labelling.greed = HASTY_GREED;
            labelling.far_first = true;
            self.sort_by_urgency(&mut order);
            return self.achieve_goals(&mut order, labelling, bound, stop);
        }
        if manner == Manner::Thorough || self.random.random_bool(0.3) {
            labelling.greed = 1.0;
            return self.achieve_earliest_first(labelling, bound, stop);
        }
        order.shuffle(&mut self.random);
        if self.random.random_bool(0.6) {
            self.sort_by_urgency(&mut order);
        }
        self.achieve_goals(&mut order, labelling, bound, stop)
    }
}

#[cfg(test)]
mod tests {
    use super::Manner;
    use crate::schedule::testing::ground_texts;
    use crate::schedule::workshop::Workshop;

    const LIFT: &str = "(define (domain lift) (:requirements :typing :durative-actions)
     (:types floor) (:predicates (lift-at ?f - floor) (waits ?f - floor) (aboard) (home))
     (:durative-action move :parameters (?a ?b - floor) :duration (= ?duration 5)
      :condition (at start (lift-at ?a))
      :effect (and (at start (not (lift-at ?a))) (at end (lift-at ?b))))
     (:durative-action board :parameters (?f - floor) :duration (= ?duration 1)
      :condition (and (over all (lift-at ?f)) (at start (waits ?f)))
      :effect (and (at start (not (waits ?f))) (at end (aboard))))
     (:durative-action leave :parameters () :duration (= ?duration 1)
      :condition (and (over all (lift-at f3)) (at start (aboard)))
      :effect (and (at start (not (aboard))) (at end (home)))))";

    #[test]
    fn a_hasty_list_fetches_the_passenger_before_it_goes_where_he_wants_to() {
        let domain = LIFT.replace("(:predicates", "(:constants f1 f2 f3 - floor) (:predicates");
        let problem =
            "(define (problem p) (:domain lift) (:init (lift-at f1) (waits f2)) (:goal (home)))";
        let task = ground_texts(&domain, problem);
        let mut workshop = Workshop::new(&task, 0, None).unwrap();
        let steps = |workshop: &Workshop| workshop.state.list.len();
        assert!(workshop.construct(Manner::Hasty, f64::INFINITY, &|| false));
        assert_eq!(steps(&workshop), 4);
        // The nearest need first: the lift goes there, and back, before it fetches him.
        assert!(workshop.construct(Manner::Thorough, f64::INFINITY, &|| false));
        assert!(steps(&workshop) > 4);
    }
}
