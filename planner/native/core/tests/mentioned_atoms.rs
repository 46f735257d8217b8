//! Atoms that a condition mentions without depending on them: no happening that writes them stands
//! at the same moment (VAL's reading of PDDL 2.1, definition 12).

mod support;

use planner_core::attachment::NoAttachments;
use support::{options, read, solved};

/// Shipping waits for the orders that include a product; the other orders are only mentioned.
const ORDERS: &str = "(define (domain orders)
 (:requirements :typing :durative-actions :adl)
 (:types order product)
 (:predicates (includes ?o - order ?p - product) (started ?o - order) (made ?p - product))
 (:durative-action start :parameters (?o - order) :duration (= ?duration 2)
  :effect (at end (started ?o)))
 (:durative-action make :parameters (?p - product) :duration (= ?duration 3)
  :condition (at start (forall (?o - order) (imply (includes ?o ?p) (started ?o))))
  :effect (at end (made ?p))))";

#[test]
fn plans_keep_clear_of_them() {
    let (domain, problem) = read(
        ORDERS,
        "(define (problem p) (:domain orders) (:objects a b c - order x y z - product)
         (:init (includes a x) (includes b y) (includes c z) (includes a z))
         (:goal (and (made x) (made y) (made z) (started a) (started b) (started c))))",
    );
    for seed in 0..8 {
        let mut options = options();
        options.seed = seed;
        options.node_limit = Some(600);
        let report = solved(&domain, &problem, &NoAttachments, &options);
        assert!(report.schedules > 0, "the list-schedule space takes part");
        let best = report
            .plans
            .last()
            .map_or(f64::INFINITY, |found| found.cost);
        assert!((5.0..5.1).contains(&best), "{best}");
    }
}

/// A gate that timed literals open and shut is mentioned by an action that does not need it.
#[test]
fn timed_literals_are_kept_clear_of_too() {
    let (domain, problem) = read(
        "(define (domain gate)
         (:requirements :durative-actions :adl :timed-initial-literals)
         (:predicates (gate) (key) (in) (other))
         (:durative-action enter :parameters () :duration (= ?duration 2)
          :condition (at start (or (gate) (key))) :effect (at end (in)))
         (:durative-action wait :parameters () :duration (= ?duration 4)
          :effect (at end (other))))",
        "(define (problem p) (:domain gate) (:init (key) (at 4 (gate)) (at 9 (not (gate))))
         (:goal (and (in) (other))))",
    );
    let report = solved(&domain, &problem, &NoAttachments, &options());
    assert_eq!(report.plans.last().map(|found| found.cost), Some(4.0));
}
