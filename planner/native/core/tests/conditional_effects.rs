//! Conditional effects beside unconditional ones on the same fact.

mod support;

use planner_core::attachment::NoAttachments;
use support::{options, read, solved};

/// Knocking shows a light at its start, if the lamp is lit, and puts it out at its end.
const LAMP: &str = "(define (domain lamp)
 (:requirements :durative-actions :conditional-effects)
 (:predicates (lit) (light) (seen) (knocked))
 (:durative-action knock :parameters () :duration (= ?duration 4)
  :effect (and (when (at start (lit)) (at start (light))) (at end (not (light)))
   (at end (knocked))))
 (:durative-action look :parameters () :duration (= ?duration 1)
  :condition (at start (light)) :effect (at end (seen))))";

#[test]
fn an_unconditional_end_delete_follows_a_conditional_start_add() {
    let (domain, problem) = read(
        LAMP,
        "(define (problem p) (:domain lamp) (:init (lit)) (:goal (and (seen) (knocked))))",
    );
    let report = solved(&domain, &problem, &NoAttachments, &options());
    assert!(!report.plans.is_empty());
    let (domain, problem) = read(
        LAMP,
        "(define (problem p) (:domain lamp) (:init (lit)) (:goal (and (knocked) (light))))",
    );
    let report = solved(&domain, &problem, &NoAttachments, &options());
    assert!(
        report.plans.is_empty(),
        "the light is out when knocking ends"
    );
}

#[test]
fn an_unconditional_end_add_follows_a_conditional_start_delete() {
    let domain = LAMP.replace(
        "(at start (light))) (at end (not (light)))",
        "(at start (not (light)))) (at end (light))",
    );
    let (domain, problem) = read(
        &domain,
        "(define (problem p) (:domain lamp) (:init (lit) (light)) (:goal (and (knocked) (seen))))",
    );
    let report = solved(&domain, &problem, &NoAttachments, &options());
    assert!(!report.plans.is_empty());
}

#[test]
fn a_conditional_start_effect_may_break_the_own_invariant() {
    let domain = LAMP.replace(
        "(:durative-action look :parameters () :duration (= ?duration 1)",
        "(:durative-action risky :parameters () :duration (= ?duration 1)
          :condition (over all (light))
          :effect (and (when (at start (lit)) (at start (not (light)))) (at end (seen))))
         (:durative-action look :parameters () :duration (= ?duration 9)",
    );
    let (domain, problem) = read(
        &domain,
        "(define (problem p) (:domain lamp) (:init (lit) (light)) (:goal (seen)))",
    );
    let report = solved(&domain, &problem, &NoAttachments, &options());
    assert_eq!(report.plans.last().map(|found| found.cost), Some(9.0));
}
