//! Two threads.

mod support;

use std::time::Duration;

use planner_core::attachment::NoAttachments;
use planner_core::outcome::Outcome;
use planner_core::solve::SolveOptions;
use support::{read, solved};

/// There is one match, and it does not burn long enough for both things that need its light: no
/// plan, but a relaxed one, and none of the proofs of unsolvability applies where actions overlap.
const STUCK: &str = "(define (domain stuck)
 (:requirements :durative-actions)
 (:predicates (match) (light) (found) (opened))
 (:durative-action strike :parameters () :duration (= ?duration 4)
  :condition (at start (match))
  :effect (and (at start (not (match))) (at start (light)) (at end (not (light)))))
 (:durative-action find :parameters () :duration (= ?duration 3)
  :condition (over all (light)) :effect (at end (found)))
 (:durative-action open :parameters () :duration (= ?duration 3)
  :condition (and (at start (found)) (over all (light))) :effect (at end (opened))))";

#[test]
fn an_exhausted_search_ends_the_other_one() {
    let (domain, problem) = read(
        STUCK,
        "(define (problem p) (:domain stuck) (:init (match)) (:goal (opened)))",
    );
    let options = SolveOptions {
        timeout: Some(Duration::from_secs(600)),
        threads: 2,
        ..SolveOptions::default()
    };
    let report = solved(&domain, &problem, &NoAttachments, &options);
    assert_eq!(report.outcome, Outcome::Exhausted);
    assert!(report.schedules > 0, "the other search was still at work");
}
