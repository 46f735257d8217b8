//! Several bounds on a duration of which more than one depends on the state: all of them hold.

mod support;

use planner_core::attachment::NoAttachments;
use planner_core::outcome::Outcome;
use support::{options, read, solved};

const BOILER: &str = "(define (domain boiler)
 (:requirements :durative-actions :duration-inequalities :numeric-fluents)
 (:predicates (cold) (hot))
 (:functions (fuel) (pressure) (least) (need))
 (:durative-action heat :parameters ()
  :duration (and (>= ?duration (least)) (>= ?duration (need))
   (<= ?duration (fuel)) (<= ?duration (pressure)))
  :condition (at start (cold))
  :effect (and (at start (not (cold))) (at end (hot))))
 (:durative-action fill :parameters () :duration (= ?duration 1)
  :effect (and (at end (increase (fuel) 3)) (at end (increase (pressure) 3))
   (at end (increase (least) 1)) (at end (increase (need) 0)))))";

fn problem(fuel: u32, pressure: u32, least: u32, need: u32) -> String {
    format!(
        "(define (problem p) (:domain boiler) (:init (cold) (= (fuel) {fuel})
         (= (pressure) {pressure}) (= (least) {least}) (= (need) {need})) (:goal (hot)))"
    )
}

fn makespan(fuel: u32, pressure: u32, least: u32, need: u32) -> Option<f64> {
    let (domain, problem) = read(BOILER, &problem(fuel, pressure, least, need));
    let report = solved(&domain, &problem, &NoAttachments, &options());
    report.plans.last().map(|found| found.cost)
}

#[test]
fn the_larger_lower_bound_counts() {
    assert_eq!(makespan(9, 9, 2, 5), Some(5.0));
    assert_eq!(makespan(9, 9, 6, 5), Some(6.0));
}

#[test]
fn the_smaller_upper_bound_counts() {
    // Heating needs 5 s at least; fuel, then pressure, has to be filled up once.
    for (fuel, pressure) in [(3, 9), (9, 3)] {
        let found = makespan(fuel, pressure, 2, 5);
        assert!(
            found.is_some_and(|found| (6.0..6.1).contains(&found)),
            "{found:?}"
        );
    }
}

#[test]
fn bounds_that_leave_nothing_leave_no_plan() {
    let closed = BOILER.replace(
        ":duration (= ?duration 1)",
        ":duration (= ?duration 1) :condition (at start (hot))",
    );
    let (domain, problem) = read(&closed, &problem(3, 9, 2, 5));
    let report = solved(&domain, &problem, &NoAttachments, &options());
    assert!(report.plans.is_empty());
    assert_ne!(report.outcome, Outcome::Solved);
}
