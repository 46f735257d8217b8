//! Goal-directed relaxed exploration from a time-stamped state.
//!
//! Labels are settled in the order of `label + distance` (A*, Hart, Nilsson, Raphael 1968), where
//! `distance` is the length of the shortest chain of rules from a proposition to the target: a
//! lower bound that ignores all other needs and is computed once a target. A label is the
//! earliest time (max over needs) plus `effort` times the additive cost (h_add), so that one
//! parameter goes from greedy list scheduling to plans that save work.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::schedule::distances::{Ahead, DistanceCache, Distances, key};
use crate::schedule::model::NONE;
use crate::schedule::propositions::Propositions;
use crate::schedule::question::{Labelling, Question};
use crate::schedule::successors::Successors;

/// Rules looked at between two looks at whether to go on.
const STOP_PERIOD: usize = 4_096;

#[derive(Clone, Copy, Debug)]
struct Label {
    time: f32,
    cost: f32,
    supporter: u32,
    /// Twice the generation, and one more when it is settled.
    stamp: u32,
}

/// Reusable memory of the exploration.
#[derive(Clone, Debug)]
pub struct Exploration {
    labels: Vec<Label>,
    generation: u32,
    queue: BinaryHeap<Reverse<u64>>,
    distances: DistanceCache,
    successors: Successors,
    visited: Vec<u32>,
    /// The first rule that waits for a proposition, and in which generation.
    waiting: Vec<(u32, u32)>,
    /// The rule that waits for the same proposition behind a rule, and how far a rule that waits is
    /// from the target.
    behind: Vec<(u32, f32)>,
    /// Whether rules cost what they last.
    cost_is_time: bool,
    /// Labels settled since creation.
    pub settled: u64,
    /// Whether the last exploration left out what would be too late.
    pub cut: bool,
    /// Whether it left out what destroys goals.
    pub protected: bool,
}

impl Exploration {
    /// Memory for a task.
    pub fn new(propositions: &Propositions, cost_is_time: bool) -> Self {
        let fresh = Label {
            time: 0.0,
            cost: 0.0,
            supporter: NONE,
            stamp: 0,
        };
        Self {
            labels: vec![fresh; propositions.count()],
            generation: 0,
            queue: BinaryHeap::new(),
            distances: DistanceCache::default(),
            successors: Successors::new(propositions),
            visited: vec![0; propositions.count()],
            waiting: vec![(0, NONE); propositions.count()],
            behind: vec![(NONE, 0.0); propositions.rules.len()],
            cost_is_time,
            settled: 0,
            cut: false,
            protected: false,
        }
    }

    /// Least increase of a label per unit of distance.
    fn weight(&self, labelling: Labelling) -> f32 {
        if self.cost_is_time {
            1.0 + labelling.effort
        } else {
            1.0
        }
    }

    /// Finds a relaxed plan for a target that does not hold: operators with the propositions they
    /// were chosen for, in causal order. Returns the label of the target, infinite if unreachable.
    pub fn relaxed_plan(&mut self, question: Question<'_>, plan: &mut Vec<(u32, u32)>) -> f32 {
        plan.clear();
        let target = question.target;
        let mut distance = self.distances.take(question.propositions, target);
        let label = self.explore(&question, &mut distance);
        self.distances.give_back(target, distance);
        if label.is_finite() {
            let far_first = question.labelling.far_first;
            self.extract(question.propositions, target, far_first, plan);
        }
        label
    }

    fn explore(&mut self, question: &Question<'_>, distance: &mut Distances) -> f32 {
        let Question {
            model,
            propositions,
            state,
            target,
            labelling,
            ..
        } = *question;
        self.generation += 2;
        let generation = self.generation;
        self.queue.clear();
        self.cut = false;
        self.protected = false;
        let mut bound = f32::INFINITY;
        for (index, word) in state.truth.iter().enumerate() {
            let mut word = *word;
            while word != 0 {
                let fact = index as u32 * 64 + word.trailing_zeros();
                word &= word - 1;
                self.seed(question, fact, distance);
            }
        }
        for index in 0..propositions.extra.len() as u32 {
            let proposition = propositions.fact_count + index;
            if distance.propositions[proposition as usize].is_finite()
                && propositions.holds(state, proposition)
            {
                self.seed(question, proposition, distance);
            }
        }
        for fact in &model.windowed {
            if labelling.windows
                && !state.holds(*fact, true)
                && state.available(model, *fact, true).is_finite()
            {
                self.seed(question, *fact, distance);
            }
        }
        for proposition in &propositions.lasting {
            if labelling.windows && propositions.held_once(model, state, *proposition) {
                self.seed(question, *proposition, distance);
            }
        }
        for rule in &propositions.free {
            let ahead = distance.of_rule(propositions, *rule);
            self.fire(question, (ahead, *rule), distance, &mut bound);
        }
        let weight = self.weight(labelling);
        let mut looked = 0;
        while let Some(Reverse(entry)) = self.queue.pop() {
            let proposition = entry as u32;
            let label = &mut self.labels[proposition as usize];
            if label.stamp != generation {
                continue;
            }
            label.stamp += 1;
            self.settled += 1;
            if proposition == target {
                return label.time + labelling.effort * label.cost;
            }
            let value = label.time + labelling.effort * label.cost;
            let supporter = label.supporter;
            let leads = |ahead: f32, bound: f32| value + weight * ahead < bound;
            looked += 1;
            if supporter == NONE {
                for index in distance.watching(propositions, proposition) {
                    let (ahead, rule) = distance.entry(index);
                    if !leads(ahead, bound) {
                        break;
                    }
                    looked += 1;
                    self.fire(question, (ahead, rule), distance, &mut bound);
                }
            } else {
                for index in self
                    .successors
                    .behind(model, propositions, supporter, proposition)
                {
                    let rule = self.successors.entry(index);
                    let ahead = distance.of_rule(propositions, rule);
                    looked += 1;
                    if leads(ahead, bound) {
                        self.fire(question, (ahead, rule), distance, &mut bound);
                    }
                }
            }
            let mut rule = self.first_waiting(proposition);
            while rule != NONE {
                let (next, ahead) = self.behind[rule as usize];
                looked += 1;
                if leads(ahead, bound) {
                    self.fire(question, (ahead, rule), distance, &mut bound);
                }
                rule = next;
            }
            if looked > STOP_PERIOD {
                if (question.stop)() {
                    break;
                }
                looked = 0;
            }
        }
        f32::INFINITY
    }

    /// The first of the rules that wait for a proposition to be settled.
    fn first_waiting(&self, proposition: u32) -> u32 {
        let (generation, rule) = self.waiting[proposition as usize];
        if generation == self.generation {
            rule
        } else {
            NONE
        }
    }

    fn seed(&mut self, question: &Question<'_>, proposition: u32, distance: &Distances) {
        let ahead = distance.propositions[proposition as usize];
        if !ahead.is_finite() {
            return;
        }
        let time = question
            .propositions
            .time(question.model, question.state, proposition) as f32;
        if time + ahead >= question.latest {
            self.cut = true;
            return;
        }
        self.labels[proposition as usize] = Label {
            time,
            cost: 0.0,
            supporter: NONE,
            stamp: self.generation,
        };
        let labelling = question.labelling;
        let priority = time + self.weight(labelling) * labelling.greed * ahead;
        self.queue.push(key(priority, proposition));
    }

    /// Labels what a rule adds once all it needs is settled; until then the rule waits for one of
    /// its needs.
    fn fire(
        &mut self,
        question: &Question<'_>,
        (ahead, rule_index): Ahead,
        distance: &Distances,
        bound: &mut f32,
    ) {
        let Question {
            model,
            propositions,
            state,
            target,
            labelling,
            restriction,
            ..
        } = *question;
        let rule = &propositions.rules[rule_index as usize];
        let acts = rule.operator != NONE;
        if acts && labelling.protect && state.destroys_goal(model, rule.operator) {
            self.protected = true;
            return;
        }
        let generation = self.generation;
        let mut time = 0.0f32;
        let mut cost = 0.0f32;
        let mut direct = true;
        for need in propositions.needs(rule) {
            let label = &self.labels[need.proposition as usize];
            if label.stamp != generation + 1 {
                self.behind[rule_index as usize] = (self.first_waiting(need.proposition), ahead);
                self.waiting[need.proposition as usize] = (generation, rule_index);
                return;
            }
            let lag = if need.at_end { rule.duration } else { 0.0 };
            time = time.max(label.time - lag);
            cost += label.cost;
            direct &= label.supporter == NONE;
        }
        if acts && direct {
            // Nothing relaxed about it: readers, numeric conditions and capacities count.
            match state.earliest(model, rule.operator) {
                Some(dispatch) => time = time.max(dispatch.start as f32),
                None => return,
            }
        }
        let mut duration = rule.duration;
        if labelling.noise > 0.0 {
            let hash = (rule_index ^ labelling.salt).wrapping_mul(0x9E37_79B1);
            let hash = (hash ^ (hash >> 15)).wrapping_mul(0x85EB_CA77);
            duration *= 1.0 + labelling.noise * ((hash >> 8) as f32 / 16_777_216.0);
        }
        let cost = cost + rule.cost;
        let weight = self.weight(labelling);
        let first_add = propositions.first_add(rule);
        for (index, add) in propositions.adds(rule).iter().enumerate() {
            let ahead = distance.propositions[add.proposition as usize];
            if !ahead.is_finite()
                || add.proposition == labelling.without
                || add.proposition != target && self.successors.is_dead_end(first_add + index)
            {
                continue;
            }
            if add.proposition == target && !restriction.admits(propositions, rule_index) {
                continue;
            }
            // The operator that achieves the target has to be paid for to its end, even if the target
            // holds from its start on.
            let lasts = add.at_end || add.proposition == target;
            let reached = time + if lasts { duration } else { 0.0 };
            let value = reached + labelling.effort * cost;
            if reached + ahead >= question.latest {
                self.cut = true;
                continue;
            }
            if value + weight * ahead >= *bound {
                continue;
            }
            let priority = value + weight * labelling.greed * ahead;
            let label = &mut self.labels[add.proposition as usize];
            let settled = label.stamp == generation + 1;
            let known = label.stamp == generation;
            if settled || known && label.time + labelling.effort * label.cost <= value {
                continue;
            }
            *label = Label {
                time: reached,
                cost,
                supporter: rule_index,
                stamp: generation,
            };
            if add.proposition == target {
                *bound = value;
            }
            self.queue.push(key(priority, add.proposition));
        }
    }

    fn extract(
        &mut self,
        propositions: &Propositions,
        target: u32,
        far_first: bool,
        plan: &mut Vec<(u32, u32)>,
    ) {
        let mut stack = vec![(target, false)];
        let generation = self.generation;
        while let Some((proposition, leaving)) = stack.pop() {
            let supporter = self.labels[proposition as usize].supporter;
            if leaving {
                let rule = &propositions.rules[supporter as usize];
                if rule.operator != NONE {
                    plan.push((rule.operator, proposition));
                }
                if far_first {
                    for add in propositions.adds(rule) {
                        self.visited[add.proposition as usize] = generation;
                    }
                }
                continue;
            }
            if supporter == NONE || self.visited[proposition as usize] == generation {
                continue;
            }
            self.visited[proposition as usize] = generation;
            stack.push((proposition, true));
            let rule = &propositions.rules[supporter as usize];
            let from = stack.len();
            for need in propositions.needs(rule) {
                stack.push((need.proposition, false));
            }
            // What is available first comes first in the plan: it has to be on top.
            stack[from..].sort_by(|left, right| {
                let time = |entry: &(u32, bool)| self.labels[entry.0 as usize].time;
                time(right).total_cmp(&time(left))
            });
            if far_first {
                stack[from..].reverse();
            }
        }
        let mut seen: Vec<u32> = Vec::with_capacity(plan.len());
        plan.retain(|(operator, _)| {
            let fresh = !seen.contains(operator);
            if fresh {
                seen.push(*operator);
            }
            fresh
        });
    }
}
