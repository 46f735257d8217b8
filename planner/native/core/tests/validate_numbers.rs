//! The validator on numbers: effects, conditions, durations, the metric.

#[path = "support/validation.rs"]
mod validation;

use validation::{Case, case};

/// Numbers: capacity, energy, ?duration in effects, duration inequalities.
fn numbers() -> Case {
    case(
        "(define (domain numbers)
          (:requirements :typing :durative-actions :numeric-fluents :duration-inequalities :negative-preconditions)
          (:types robot - object)
          (:predicates (charged ?r - robot) (busy ?r - robot) (done))
          (:functions (energy ?r - robot) (capacity) (load) (total-cost) (unset))
          (:durative-action charge :parameters (?r - robot)
           :duration (and (>= ?duration 1) (<= ?duration 10))
           :condition (and (at start (not (busy ?r))) (over all (<= (energy ?r) (capacity))))
           :effect (and (at start (busy ?r)) (at end (not (busy ?r)))
                        (at end (increase (energy ?r) (* 2 ?duration))) (at end (charged ?r))))
          (:action pick :parameters (?r - robot)
           :precondition (and (< (load) 2))
           :effect (and (increase (load) 1) (increase (total-cost) 3)))
          (:action count :parameters () :effect (increase (total-cost) 1))
          (:action reset :parameters () :effect (assign (total-cost) 0))
          (:action twice :parameters () :effect (and (assign (load) 0) (assign (load) 1)))
          (:action divide :parameters () :effect (scale-down (load) (- (capacity) (capacity))))
          (:action read :parameters () :precondition (>= (unset) 0) :effect (done)))",
        "(define (problem p) (:domain numbers) (:objects r1 r2 - robot)
          (:init (= (energy r1) 0) (= (energy r2) 3) (= (capacity) 20) (= (load) 0))
          (:goal (>= (energy r1) 6)) (:metric maximize (- (energy r1) (total-cost))))",
    )
}

#[test]
fn duration_enters_effects_and_the_metric_is_evaluated_at_the_end() {
    let verdict = numbers().accepted("0: (charge r1)[4] 1: (pick r1) 2: (pick r2)");
    assert_eq!(verdict.metric, Some(8.0 - 6.0));
}

#[test]
fn duration_inequalities_bound_both_sides() {
    let (code, message) = numbers().rejected("0: (charge r1)[0.5]");
    assert_eq!(code, "duration");
    assert!(message.contains("0.5 but must be >= 1"), "{message}");
    assert_eq!(numbers().rejected("0: (charge r1)[11]").0, "duration");
}

#[test]
fn a_numeric_condition_shows_the_values() {
    let (code, message) =
        numbers().rejected("0: (charge r1)[4] 5: (pick r1) 6: (pick r1) 7: (pick r1)");
    assert_eq!(code, "condition");
    assert!(
        message.contains("its condition (< (load) 2) does not hold"),
        "{message}"
    );
    assert!(
        message.contains("(load) is 2 since 6 ((pick r1))"),
        "{message}"
    );
}

#[test]
fn increases_commute_but_assignments_and_readers_do_not() {
    numbers().accepted("0: (charge r1)[4] 1: (count) 1: (pick r1)");
    assert_eq!(
        numbers()
            .rejected("0: (charge r1)[4] 1: (count) 1: (reset)")
            .0,
        "interference"
    );
    // Both read the load and increase it.
    assert_eq!(
        numbers()
            .rejected("0: (charge r1)[4] 1: (pick r1) 1: (pick r2)")
            .0,
        "interference"
    );
}

#[test]
fn numeric_faults_have_names() {
    assert_eq!(
        numbers().rejected("0: (charge r1)[4] 1: (twice)").0,
        "double-assignment"
    );
    assert_eq!(
        numbers().rejected("0: (charge r1)[4] 1: (divide)").0,
        "not-a-number"
    );
    let (code, message) = numbers().rejected("0: (charge r1)[4] 1: (read)");
    assert_eq!(code, "undefined");
    assert!(message.contains("(unset) has no value"), "{message}");
}
