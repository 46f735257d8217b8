//! Sequential plans: compression, interchangeable objects, timing.

mod support;

use planner_core::attachment::NoAttachments;
use planner_core::epoch::calls::Calls;
use planner_core::epoch::compiled::Compiled;
use planner_core::epoch::search::Status;
use planner_core::epoch::state::State;
use planner_core::epoch::successors::Successors;
use planner_core::epoch::transitions::Transitions;
use planner_core::grounding::{GroundingLimits, ground};
use planner_core::heuristic::relaxed::RelaxedTask;
use planner_core::sequential::compression::compress;
use planner_core::sequential::symmetry::Symmetry;
use planner_core::sequential::timing::one_after_the_other;
use planner_core::sequential::width::WidthSearch;
use planner_core::task::{OperatorId, Task};
use support::{check, read};

/// Boxes go through a gate, one at a time; the red one has to end elsewhere.
const GATE: &str = "(define (domain gate)
 (:requirements :typing :durative-actions)
 (:types box side)
 (:predicates (in ?b - box ?s - side) (free) (way ?s ?t - side))
 (:durative-action pass :parameters (?b - box ?s ?t - side) :duration (= ?duration 2)
  :condition (and (at start (free)) (at start (in ?b ?s)) (over all (way ?s ?t)))
  :effect (and (at start (not (free))) (at end (free))
   (at start (not (in ?b ?s))) (at end (in ?b ?t)))))";

const BOXES: &str = "(define (problem p) (:domain gate)
 (:objects a b red - box left right yard - side)
 (:init (in a left) (in b right) (in red left) (free) (way left right) (way right left)
  (way right yard))
 (:goal (and (in a right) (in b right) (in red yard))))";

fn task() -> Task {
    let (domain, problem) = read(GATE, BOXES);
    ground(
        &domain,
        &problem,
        &NoAttachments,
        &GroundingLimits::default(),
    )
    .expect("grounds")
}

fn named(task: &Task, name: &str) -> OperatorId {
    let ids = (0..task.operators.len() as u32).map(OperatorId);
    let mut found = ids.filter(|id| task.operator_name(*id) == name);
    found.next().expect("grounded")
}

#[test]
fn what_is_only_locked_is_no_effect() {
    let task = task();
    let compressed = compress(&task).expect("compressible");
    let pass = &compressed.operators[named(&task, "pass a left right").index()];
    assert!(pass.duration.is_none());
    assert_eq!(pass.start_condition.positive.len(), 2);
    let changed = pass.start_effects.len();
    assert_eq!(changed, 2, "the gate is free before and afterwards");
}

#[test]
fn steps_are_timed_in_the_real_task() {
    let task = task();
    let (domain, problem) = read(GATE, BOXES);
    let compiled = Compiled::new(&task);
    let calls = Calls::new(&task, &NoAttachments);
    let transitions = Transitions {
        compiled: &compiled,
        calls: &calls,
    };
    let steps = [
        "pass a left right",
        "pass red left right",
        "pass red right yard",
    ];
    let operators = steps.map(|name| named(&task, name));
    let found = one_after_the_other(&transitions, &operators).expect("a plan");
    check(&domain, &problem, &NoAttachments, &found.plan(&task));
    assert!(one_after_the_other(&transitions, &operators[..2]).is_none());
    assert!(one_after_the_other(&transitions, &operators[1..]).is_none());
}

#[test]
fn boxes_with_one_goal_are_interchangeable() {
    let task = task();
    let compressed = compress(&task).expect("compressible");
    let symmetry = Symmetry::new(&compressed).expect("two boxes");
    let names: Vec<Vec<&str>> = symmetry
        .classes
        .iter()
        .map(|class| {
            let names = class
                .iter()
                .map(|o| task.object_names[*o as usize].as_str());
            names.collect()
        })
        .collect();
    assert_eq!(
        names,
        [["a", "b"]],
        "red has a goal of its own, the sides have ways of theirs"
    );
}

#[test]
fn fingerprints_do_not_tell_them_apart() {
    let compressed = compress(&task()).expect("compressible");
    let symmetry = Symmetry::new(&compressed).expect("two boxes");
    let compiled = Compiled::new(&compressed);
    let fingerprint = |facts: &[&str]| {
        let mut state = State::initial(&compiled);
        state.facts.iter_mut().for_each(|word| *word = 0);
        for fact in facts {
            let id = compressed.facts.iter().position(|name| name == fact);
            let id = id.unwrap_or_else(|| panic!("{fact} in {:?}", compressed.facts));
            state.facts[id / 64] |= 1 << (id % 64);
        }
        symmetry.fingerprint(&state)
    };
    let one = fingerprint(&["in a left", "in b right", "in red left"]);
    assert_eq!(
        one,
        fingerprint(&["in b left", "in a right", "in red left"])
    );
    assert_ne!(
        one,
        fingerprint(&["in a left", "in b right", "in red right"])
    );
    assert_ne!(one, fingerprint(&["in a left", "in b left", "in red left"]));
}

#[test]
fn plans_are_not_made_for_durations_that_depend_on_the_state() {
    let domain = GATE
        .replace(":typing", ":typing :numeric-fluents")
        .replace(
            "(:durative-action",
            "(:functions (speed)) (:durative-action",
        )
        .replace("(= ?duration 2)", "(= ?duration (speed))")
        .replace(
            "(at end (free))",
            "(at end (free)) (at end (increase (speed) 1))",
        );
    let problem = BOXES.replace("(free)", "(free) (= (speed) 1)");
    let (domain, problem) = read(&domain, &problem);
    let task = ground(
        &domain,
        &problem,
        &NoAttachments,
        &GroundingLimits::default(),
    );
    assert!(compress(&task.expect("grounds")).is_none());
}

/// Steps of the width search on a compressed task, and how it ended.
fn by_width(compressed: &Task) -> (Status, Vec<OperatorId>) {
    let compiled = Compiled::new(compressed);
    let calls = Calls::new(compressed, &NoAttachments);
    let transitions = Transitions {
        compiled: &compiled,
        calls: &calls,
    };
    let (successors, relaxed) = (Successors::new(&compiled), RelaxedTask::new(compressed));
    let mut search = WidthSearch::new(transitions, &successors, &relaxed, 1 << 24);
    let mut steps = Vec::new();
    let status = search.run(10_000, &mut || false, &mut |found| {
        steps = found.steps.iter().map(|step| step.0).collect();
    });
    (status, steps)
}

#[test]
fn the_width_search_finds_steps_for_the_real_task() {
    let task = task();
    let (domain, problem) = read(GATE, BOXES);
    let compressed = compress(&task).expect("compressible");
    let (status, steps) = by_width(&compressed);
    assert_eq!(status, Status::Found);
    assert_eq!(
        steps.len(),
        3,
        "a to the right, red to the right and on to the yard"
    );
    assert_eq!(by_width(&compressed).1, steps, "deterministic");
    let compiled = Compiled::new(&task);
    let calls = Calls::new(&task, &NoAttachments);
    let transitions = Transitions {
        compiled: &compiled,
        calls: &calls,
    };
    let found = one_after_the_other(&transitions, &steps).expect("a plan");
    check(&domain, &problem, &NoAttachments, &found.plan(&task));
}

#[test]
fn the_width_search_ends_where_there_is_no_plan() {
    // The relaxation has one: the key is used up by the first of two doors.
    let domain = "(define (domain doors) (:requirements :strips)
     (:predicates (key) (one) (other))
     (:action first :parameters () :precondition (key) :effect (and (one) (not (key))))
     (:action second :parameters () :precondition (key) :effect (and (other) (not (key)))))";
    let problem = "(define (problem p) (:domain doors) (:init (key)) (:goal (and (one) (other))))";
    let (domain, problem) = read(domain, problem);
    let limits = GroundingLimits::default();
    let task = ground(&domain, &problem, &NoAttachments, &limits).expect("grounds");
    let compressed = compress(&task).expect("compressible");
    assert_eq!(by_width(&compressed).0, Status::Exhausted);
}
