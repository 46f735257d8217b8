//! Plans of the list-schedule space against the validator, on random problems.

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use planner_core::attachment::NoAttachments;
use planner_core::grounding::{GroundingLimits, ground};
use planner_core::pddl::model::{Domain, Problem};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::plan::Plan;
use planner_core::schedule::{Ending, Limits, Optimiser, Schedule};
use planner_core::syntax::source::SourceFile;
use planner_core::task::{OperatorId, Task};
use planner_core::validate::{Options, validate};
use proptest::prelude::*;

/// Explorers visit targets, clearers open the blockades in between.
const RESCUE: &str = "(define (domain rescue)
 (:requirements :typing :durative-actions :numeric-fluents)
 (:types robot place - object scout digger - robot)
 (:predicates (at ?r - robot ?x - place) (open ?x - place) (seen ?x - place))
 (:functions (way ?x ?y - place))
 (:durative-action move :parameters (?r - robot ?x ?y - place)
  :duration (= ?duration (way ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (open ?x)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y))))
 (:durative-action look :parameters (?r - scout ?x - place)
  :duration (= ?duration 2)
  :condition (and (over all (at ?r ?x)) (at start (open ?x)))
  :effect (and (at end (seen ?x))))
 (:durative-action dig :parameters (?r - digger ?x - place)
  :duration (= ?duration 5)
  :condition (and (over all (at ?r ?x)))
  :effect (and (at end (open ?x)))))";

/// A ferry with two seats: capacity, passengers, a gate that opens and shuts, a light that has to
/// be on while somebody boards, and boarding that wets whoever has no coat.
const FERRY: &str = "(define (domain ferry)
 (:requirements :typing :durative-actions :numeric-fluents :negative-preconditions
  :timed-initial-literals :conditional-effects)
 (:types ferry person shore)
 (:predicates (at ?f - ferry ?s - shore) (in ?p - person ?f - ferry) (on ?p - person ?s - shore)
  (gate-open ?s - shore) (lit ?s - shore) (lamp ?s - shore) (coat ?p - person) (wet ?p - person))
 (:functions (seats ?f - ferry) (fare))
 (:durative-action sail :parameters (?f - ferry ?s ?t - shore)
  :duration (= ?duration 7.5)
  :condition (and (at start (at ?f ?s)))
  :effect (and (at start (not (at ?f ?s))) (at end (at ?f ?t))))
 (:durative-action shine :parameters (?s - shore)
  :duration (= ?duration 6)
  :condition (and (at start (lamp ?s)) (at start (not (lit ?s))))
  :effect (and (at start (not (lamp ?s))) (at end (lamp ?s))
   (at start (lit ?s)) (at end (not (lit ?s)))))
 (:durative-action board :parameters (?p - person ?f - ferry ?s - shore)
  :duration (= ?duration 2.25)
  :condition (and (at start (on ?p ?s)) (over all (at ?f ?s)) (over all (lit ?s))
   (at start (gate-open ?s)) (at start (>= (seats ?f) 1)))
  :effect (and (at start (not (on ?p ?s))) (at start (decrease (seats ?f) 1))
   (at end (in ?p ?f)) (at end (increase (fare) 1))
   (when (at start (not (coat ?p))) (at end (wet ?p)))))
 (:action leave :parameters (?p - person ?f - ferry ?s - shore)
  :precondition (and (in ?p ?f) (at ?f ?s))
  :effect (and (not (in ?p ?f)) (on ?p ?s) (increase (seats ?f) 1)))
 (:durative-action dry :parameters (?p - person ?s - shore)
  :duration (= ?duration 3)
  :condition (and (over all (on ?p ?s)))
  :effect (and (at end (not (wet ?p))))))";

struct Case {
    domain: Domain,
    problem: Problem,
    task: Task,
}

fn case(domain: &str, problem: &str) -> Case {
    let (domain, diagnostics) = read_domain(&SourceFile::new("domain.pddl", domain));
    let domain = domain.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let (problem, diagnostics) = read_problem(&SourceFile::new("problem.pddl", problem), &domain);
    let problem = problem.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let task = ground(
        &domain,
        &problem,
        &NoAttachments,
        &GroundingLimits::default(),
    )
    .unwrap_or_else(|error| panic!("{error}"));
    Case {
        domain,
        problem,
        task,
    }
}

impl Case {
    fn check(&self, plan: &Plan) {
        let verdict = validate(
            &self.domain,
            &self.problem,
            plan,
            &NoAttachments,
            &Options::strict(0.001),
        );
        assert!(verdict.valid(), "{:?}\n{plan:#?}", verdict.failure);
    }

    /// All plans of a run, each checked.
    fn run(
        &self,
        seed: u64,
        nodes: u64,
        incumbent: Option<&[OperatorId]>,
    ) -> (Ending, Vec<Schedule>, f64) {
        let mut optimiser = Optimiser::new(&self.task, seed, None).expect("supported");
        let cancel = AtomicBool::new(false);
        let limits = Limits {
            deadline: None,
            patience: None,
            cancel: &cancel,
            nodes: Some(nodes),
        };
        let mut schedules = Vec::new();
        let ending = optimiser.run(incumbent, &limits, &mut |schedule| {
            self.check(&schedule.plan(&self.task));
            schedules.push(schedule.clone());
        });
        (ending, schedules, optimiser.lower_bound())
    }
}

/// Places on a line of which some are blocked.
fn rescue(places: &[(u32, bool, bool)], scouts: usize, diggers: usize) -> String {
    let mut text = String::from("(define (problem p) (:domain rescue) (:objects");
    for index in 0..places.len() {
        let _ = write!(text, " x{index}");
    }
    text += " - place";
    for (count, kind) in [(scouts, "scout"), (diggers, "digger")] {
        for index in 0..count {
            let _ = write!(text, " {kind}{index} - {kind}");
        }
    }
    text += ") (:init (open x0)";
    for (count, kind) in [(scouts, "scout"), (diggers, "digger")] {
        for index in 0..count {
            let _ = write!(text, " (at {kind}{index} x0)");
        }
    }
    for (index, (place, blocked, _)) in places.iter().enumerate() {
        if !blocked && index > 0 {
            let _ = write!(text, " (open x{index})");
        }
        // From one blocked place on, those behind it are reached through it only.
        for (other, (second, _, _)) in places.iter().enumerate() {
            let (low, high) = (index.min(other), index.max(other));
            let through = (low + 1..high).any(|middle| places[middle].1);
            if other != index && !through {
                let _ = write!(
                    text,
                    " (= (way x{index} x{other}) {})",
                    1 + place.abs_diff(*second)
                );
            }
        }
    }
    text += ") (:goal (and";
    for (index, (_, _, wanted)) in places.iter().enumerate() {
        if *wanted {
            let _ = write!(text, " (seen x{index})");
        }
    }
    text + ")))"
}

fn ferry(persons: &[(bool, bool)], seats: u32, shut: f64) -> String {
    let mut text =
        String::from("(define (problem p) (:domain ferry) (:objects f - ferry east west - shore");
    for index in 0..persons.len() {
        let _ = write!(text, " p{index} - person");
    }
    let _ = write!(
        text,
        ") (:init (at f east) (lamp east) (lamp west) (= (seats f) {seats}) (= (fare) 0) \
         (at 3 (gate-open east)) (at {shut} (not (gate-open east))) (at {} (gate-open east)) \
         (gate-open west)",
        shut + 4.0
    );
    for (index, (coat, _)) in persons.iter().enumerate() {
        let _ = write!(text, " (on p{index} east)");
        if *coat {
            let _ = write!(text, " (coat p{index})");
        }
    }
    text += ") (:goal (and (at f east)";
    for (index, (_, dry)) in persons.iter().enumerate() {
        let _ = write!(text, " (on p{index} west)");
        if *dry {
            let _ = write!(text, " (not (wet p{index}))");
        }
    }
    text + ")))"
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_rescue_plan_is_valid_and_above_the_bound(
        mut places in prop::collection::vec((0u32..60, prop::bool::weighted(0.3), prop::bool::weighted(0.6)), 2..8),
        scouts in 1usize..3,
        diggers in 1usize..3,
        seed in any::<u64>(),
    ) {
        places[0] = (0, false, false);
        places[1].2 = true;
        let case = case(RESCUE, &rescue(&places, scouts, diggers));
        let (_, schedules, bound) = case.run(seed, 60, None);
        let best = schedules.last().expect("a plan");
        prop_assert!(best.makespan >= bound - 1e-9, "{} below {bound}", best.makespan);
        let better = schedules.windows(2).all(|pair| pair[1].makespan <= pair[0].makespan);
        prop_assert!(better);
    }

    #[test]
    fn capacities_timed_literals_envelopes_and_conditional_effects_are_respected(
        persons in prop::collection::vec(any::<(bool, bool)>(), 1..4),
        seats in 1u32..3,
        shut in 6u32..12,
        seed in any::<u64>(),
    ) {
        let case = case(FERRY, &ferry(&persons, seats, f64::from(shut)));
        let (_, schedules, _) = case.run(seed, 60, None);
        prop_assert!(!schedules.is_empty());
    }
}

#[test]
fn the_same_seed_and_node_limit_give_the_same_plans() {
    let places: Vec<(u32, bool, bool)> = (0..8)
        .map(|index| (index * 17 % 40, index == 3 || index == 5, index > 0))
        .collect();
    let case = case(RESCUE, &rescue(&places, 2, 2));
    let (_, first, _) = case.run(7, 400, None);
    let (_, second, _) = case.run(7, 400, None);
    assert_eq!(first, second);
    assert!(!first.is_empty());
}

#[test]
fn an_earlier_plan_is_mended_and_kept() {
    let mut places: Vec<(u32, bool, bool)> = (0..8)
        .map(|index| (index * 17 % 40, false, index > 0))
        .collect();
    let before = case(RESCUE, &rescue(&places, 2, 2));
    let (_, schedules, _) = before.run(3, 2_000, None);
    let best = schedules.last().expect("a plan");
    let order: Vec<OperatorId> = best.operators.iter().map(|entry| entry.operator).collect();
    // The same problem: the plan is as good at once.
    let (_, kept, _) = before.run(4, 1, Some(&order));
    assert!(kept[0].makespan <= best.makespan + 1e-9);
    // A new blockade: operators are matched by name, and what no longer applies is replaced.
    places[4].1 = true;
    let after = case(RESCUE, &rescue(&places, 2, 2));
    let named: Vec<OperatorId> = order
        .iter()
        .filter_map(|operator| {
            let name = before.task.operator_name(*operator);
            (0..after.task.operators.len() as u32)
                .map(OperatorId)
                .find(|other| after.task.operator_name(*other) == name)
        })
        .collect();
    let (_, mended, _) = after.run(4, 1, Some(&named));
    assert_eq!(mended.len(), 1);
}

#[test]
fn the_bound_proves_a_chain_optimal() {
    let places = [(0, false, false), (9, true, false), (20, false, true)];
    let case = case(RESCUE, &rescue(&places, 1, 1));
    let (ending, schedules, bound) = case.run(0, 1_000, None);
    // The way to the blockade, digging, the way behind it, a look: 10 + 5 + 12 + 2.
    let best = schedules.last().expect("a plan");
    assert_eq!(ending, Ending::Optimal);
    assert!((best.makespan - bound).abs() < 1e-6);
    assert!((best.makespan - 29.0).abs() < 0.01, "{}", best.makespan);
}

#[test]
fn cost_is_minimised_where_the_metric_says_so() {
    let domain = "(define (domain d) (:requirements :durative-actions :numeric-fluents)
     (:predicates (raw) (done))
     (:functions (cost))
     (:durative-action dear :parameters () :duration (= ?duration 1)
      :condition (at start (raw)) :effect (and (at end (done)) (at end (increase (cost) 10))))
     (:durative-action cheap :parameters () :duration (= ?duration 9)
      :condition (at start (raw)) :effect (and (at end (done)) (at end (increase (cost) 2)))))";
    let problem =
        "(define (problem p) (:domain d) (:init (raw) (= (cost) 0)) (:goal (done)) METRIC)";
    for (metric, makespan) in [("", 1.0), ("(:metric minimize (cost))", 9.0)] {
        let case = case(domain, &problem.replace("METRIC", metric));
        let (_, schedules, _) = case.run(0, 200, None);
        let best = schedules.last().expect("a plan");
        assert!(
            (best.makespan - makespan).abs() < 0.01,
            "{metric} {}",
            best.makespan
        );
    }
}
