//! What is worth looking at behind a rule: not what another rule reaches in one step instead of two.
//!
//! A robot that drove from a to b gains nothing from driving on to c where it could have driven from
//! a to c at once. Relaxed exploration settles many such places, and each has rules to all others.

use std::ops::Range;

use crate::schedule::model::{Model, NONE};
use crate::schedule::propositions::{Propositions, Rule, Term};

/// Two steps may be shorter than one by this part of it without being worth a look.
const TOLERANCE: f32 = 1e-4;

/// Largest number of rules behind rules kept.
const SUCCESSOR_MEMORY: usize = 8_000_000;

/// Rules behind rules, found when they are asked for.
#[derive(Clone, Debug)]
pub struct Successors {
    /// Where the rules behind each entry of the table of adds begin and end; [`NONE`] if unknown.
    rows: Vec<(u32, u32)>,
    entries: Vec<u32>,
    dead_ends: Vec<bool>,
    /// Memory: what rules that could run instead add, and these rules, sorted.
    instead: Vec<(u32, u32)>,
}

impl Successors {
    /// Memory for a task.
    pub fn new(propositions: &Propositions) -> Self {
        Self {
            rows: vec![(NONE, NONE); propositions.count_of_adds()],
            entries: Vec::new(),
            dead_ends: vec![false; propositions.count_of_adds()],
            instead: Vec::new(),
        }
    }

    /// The rules that watch a proposition and are worth a look after a rule has added it, as a range
    /// for [`Self::entry`].
    pub fn behind(
        &mut self,
        model: &Model,
        propositions: &Propositions,
        rule: u32,
        proposition: u32,
    ) -> Range<usize> {
        let first = &propositions.rules[rule as usize];
        let adds = propositions.adds(first);
        let index = propositions.first_add(first)
            + adds
                .iter()
                .position(|add| add.proposition == proposition)
                .unwrap_or(0);
        if self.rows[index].0 == NONE {
            if self.entries.len() > SUCCESSOR_MEMORY {
                self.entries.clear();
                self.rows.fill((NONE, NONE));
            }
            let (from, to) = self.find(model, propositions, first, proposition);
            self.rows[index] = (from, to);
            // Whatever needs it watches it.
            let needing = propositions.needing.row(proposition).len();
            self.dead_ends[index] =
                from == to && needing == propositions.watching.row(proposition).len();
        }
        let (from, to) = self.rows[index];
        from as usize..to as usize
    }

    /// Whether it is known that nothing is worth a look behind an entry of the table of adds.
    pub fn is_dead_end(&self, add: usize) -> bool {
        self.dead_ends[add]
    }

    /// A rule of a range.
    pub fn entry(&self, index: usize) -> u32 {
        self.entries[index]
    }

    fn find(
        &mut self,
        model: &Model,
        propositions: &Propositions,
        first: &Rule,
        proposition: u32,
    ) -> (u32, u32) {
        let from = self.entries.len() as u32;
        let watching = propositions.watching.row(proposition);
        let needs = propositions.needs(first);
        let adds = propositions.adds(first);
        let at_end = adds
            .iter()
            .any(|add| add.proposition == proposition && add.at_end);
        let rarest = needs
            .iter()
            .min_by_key(|need| propositions.needing.row(need.proposition).len());
        let (Some(rarest), true) = (rarest, at_end && is_plain(model, first)) else {
            self.entries.extend_from_slice(watching);
            return (from, self.entries.len() as u32);
        };
        let given = |proposition: u32| {
            let mut needs = needs.iter();
            needs.any(|need| need.proposition == proposition && !need.at_end)
        };
        self.instead.clear();
        for other in propositions.needing.row(rarest.proposition) {
            let rule = &propositions.rules[*other as usize];
            let possible = is_plain(model, rule)
                && propositions
                    .needs(rule)
                    .iter()
                    .all(|need| !need.at_end && given(need.proposition));
            if possible {
                let adds = propositions.adds(rule).iter();
                self.instead
                    .extend(adds.map(|add| (add.proposition, *other)));
            }
        }
        self.instead.sort_unstable();
        for second in watching {
            let rule = &propositions.rules[*second as usize];
            let known = propositions
                .adds(rule)
                .iter()
                .all(|add| given(add.proposition));
            if !known && !self.is_dominated(model, propositions, (first, proposition), rule) {
                self.entries.push(*second);
            }
        }
        (from, self.entries.len() as u32)
    }

    /// Whether one rule does what two would, no later and at no higher cost.
    fn is_dominated(
        &self,
        model: &Model,
        propositions: &Propositions,
        (first, proposition): (&Rule, u32),
        second: &Rule,
    ) -> bool {
        let adds = propositions.adds(second);
        let needs = propositions.needs(second);
        let Some(least) = adds.first() else {
            return false;
        };
        let overlaps = |need: &Term| need.proposition == proposition && need.at_end;
        if !is_plain(model, second) || needs.iter().any(overlaps) {
            return false;
        }
        let lasts = (first.duration + second.duration) * (1.0 + TOLERANCE);
        let costs = (first.cost + second.cost) * (1.0 + TOLERANCE);
        let from = self
            .instead
            .partition_point(|(adds, _)| *adds < least.proposition);
        let mut instead = self.instead[from..]
            .iter()
            .take_while(|(adds, _)| *adds == least.proposition);
        instead.any(|(_, other)| {
            let other = &propositions.rules[*other as usize];
            let others = propositions.adds(other);
            let threatens = |rule: &Rule| model.threatens_goal[rule.operator as usize];
            (!threatens(other) || threatens(first) || threatens(second))
                && other.duration <= lasts
                && other.cost <= costs
                && adds.iter().all(|add| {
                    others
                        .iter()
                        .any(|one| one.proposition == add.proposition && one.at_end == add.at_end)
                })
                && changes(model, other).all(|change| {
                    changes(model, first).any(|one| one == change)
                        || changes(model, second).any(|one| one == change)
                })
        })
    }
}

/// Whether all that counts about a rule is what it needs and adds, and how long it lasts.
fn is_plain(model: &Model, rule: &Rule) -> bool {
    rule.operator != NONE && {
        let shape = &model.shapes[rule.operator as usize];
        shape.duration.is_finite()
            && model.detail(rule.operator).is_none()
            && !shape.envelope
            && !shape.excluded
            && model
                .reads(rule.operator)
                .iter()
                .all(|read| model.window_of[read.fact as usize] == NONE)
    }
}

fn changes(model: &Model, rule: &Rule) -> impl Iterator<Item = (u32, bool)> {
    model
        .writes(rule.operator)
        .iter()
        .map(|write| (write.fact, write.value))
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use proptest::prelude::*;

    use super::Successors;
    use crate::schedule::model::{EPSILON, Model, NONE};
    use crate::schedule::propositions::Propositions;
    use crate::schedule::question::Labelling;
    use crate::schedule::testing::ground_texts;
    use crate::schedule::workshop::Workshop;
    use crate::task::Task;

    /// Robots drive between places, load what lies there, and open doors for each other.
    const STORE: &str = "(define (domain store)
     (:requirements :typing :durative-actions :numeric-fluents)
     (:types robot place)
     (:predicates (at ?r - robot ?x - place) (open ?x - place) (ware ?x - place) (has ?x - place))
     (:functions (way ?x ?y - place))
     (:durative-action drive :parameters (?r - robot ?x ?y - place)
      :duration (= ?duration (way ?x ?y))
      :condition (and (at start (at ?r ?x)) (at start (open ?x)))
      :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y))))
     (:durative-action unlock :parameters (?r - robot ?x - place)
      :duration (= ?duration 4)
      :condition (over all (at ?r ?x)) :effect (at end (open ?x)))
     (:durative-action load :parameters (?r - robot ?x - place)
      :duration (= ?duration 1)
      :condition (and (at start (at ?r ?x)) (at start (ware ?x))) :effect (at end (has ?x))))";

    /// A store whose ways last what the table says, the robots at the first place.
    fn store(ways: &[Vec<u32>], open: &[bool], robots: usize) -> Task {
        let places = ways.len();
        let mut objects = String::new();
        let mut init = String::new();
        for place in 0..places {
            let _ = write!(objects, "p{place} - place ");
            if open[place] {
                let _ = write!(init, "(open p{place})");
            }
            for (other, way) in ways[place].iter().enumerate() {
                let _ = write!(init, "(= (way p{place} p{other}) {way})");
            }
        }
        for robot in 0..robots {
            let _ = write!(objects, "r{robot} - robot ");
            let _ = write!(init, "(at r{robot} p0)");
        }
        let last = places - 1;
        let problem = format!(
            "(define (problem p) (:domain store) (:objects {objects})
             (:init {init} (ware p{last})) (:goal (has p{last})))"
        );
        ground_texts(STORE, &problem)
    }

    /// Names of the operators behind where another one leads.
    fn names_behind(task: &Task, operator: &str) -> Vec<String> {
        let workshop = Workshop::new(task, 0, None).expect("supported");
        let (model, propositions) = (&workshop.model, &workshop.propositions);
        let mut successors = Successors::new(propositions);
        let named = |index: u32| task.operator_name(crate::task::OperatorId(index));
        let first = (0..task.operators.len() as u32).find(|index| named(*index) == operator);
        let first = propositions.rule_of[first.expect("grounded") as usize];
        let added = propositions.adds(&propositions.rules[first as usize])[0].proposition;
        let range = successors.behind(model, propositions, first, added);
        let mut names: Vec<String> = range
            .map(|index| named(propositions.rules[successors.entry(index) as usize].operator))
            .collect();
        names.sort();
        names
    }

    #[test]
    fn driving_on_is_looked_at_where_it_is_a_short_cut() {
        let ways = |there: u32| vec![vec![1, 5, there], vec![5, 1, 5], vec![there, 5, 1]];
        // Two robots: fewer rules need the place of one than that a door is open.
        let behind =
            |there: u32| names_behind(&store(&ways(there), &[true; 3], 2), "drive r0 p0 p1");
        assert!(!behind(10).contains(&"drive r0 p1 p2".to_owned()));
        assert!(behind(11).contains(&"drive r0 p1 p2".to_owned()));
        assert!(!behind(11).contains(&"drive r0 p1 p0".to_owned()));
        assert!(behind(10).contains(&"unlock r0 p1".to_owned()));
    }

    /// Earliest times in the relaxation by going over all rules until nothing changes.
    fn label_by_all_rules(
        model: &Model,
        propositions: &Propositions,
        workshop: &Workshop,
        target: u32,
    ) -> f32 {
        let count = propositions.count();
        let mut labels = vec![(f32::INFINITY, false); count];
        for proposition in 0..count as u32 {
            if propositions.holds(&workshop.state, proposition) {
                let time = propositions.time(model, &workshop.state, proposition) as f32;
                labels[proposition as usize] = (time, true);
            }
        }
        let mut best = f32::INFINITY;
        loop {
            let before = labels.clone();
            for rule in propositions
                .rules
                .iter()
                .filter(|rule| rule.operator != NONE)
            {
                let needs = propositions.needs(rule).iter();
                let needs: Vec<_> = needs
                    .map(|need| labels[need.proposition as usize])
                    .collect();
                let mut time = needs.iter().fold(0.0f32, |time, need| time.max(need.0));
                if needs.iter().all(|need| need.1) {
                    match workshop.state.earliest(model, rule.operator) {
                        Some(dispatch) => time = time.max(dispatch.start as f32),
                        None => continue,
                    }
                }
                for add in propositions.adds(rule) {
                    let reached = time + rule.duration;
                    if add.proposition == target {
                        best = best.min(reached);
                    }
                    let label = &mut labels[add.proposition as usize];
                    if reached < label.0 {
                        *label = (reached, false);
                    }
                }
            }
            if labels == before {
                return best;
            }
        }
    }

    proptest! {
        #[test]
        fn what_is_left_out_makes_no_label_later(
            ways in proptest::collection::vec(proptest::collection::vec(1u32..30, 5), 5),
            open in proptest::collection::vec(any::<bool>(), 5),
            robots in 1usize..3,
            choices in proptest::collection::vec(any::<u32>(), 0..6),
        ) {
            let task = store(&ways, &open, robots);
            let mut workshop = Workshop::new(&task, 0, None).expect("supported");
            for choice in choices {
                let _ = workshop.append(choice % task.operators.len() as u32);
            }
            let labelling = Labelling {
                effort: 0.0,
                noise: 0.0,
                salt: 0,
                protect: false,
                windows: true,
                greed: 1.0,
                far_first: false,
                without: NONE,
            };
            let target = workshop.propositions.goal[0];
            prop_assume!(!workshop.holds(target));
            // Dead ends are known the second time.
            let first = workshop.label(target, labelling, &|| false);
            let second = workshop.label(target, labelling, &|| false);
            let (model, propositions) = (&workshop.model, &workshop.propositions);
            let expected = label_by_all_rules(model, propositions, &workshop, target);
            prop_assert!((first - expected).abs() <= 20.0 * EPSILON as f32, "{first} {expected}");
            prop_assert_eq!(first, second);
        }
    }
}
