//! Plans whose goals are reached early on average, where the makespan leaves a choice.

mod support;

use planner_core::attachment::NoAttachments;
use planner_core::outcome::Outcome;
use planner_core::solve::SolveOptions;

/// A slow worker decides on the makespan; the order of the quick one's jobs does not matter for it.
const DOMAIN: &str = "(define (domain jobs) (:requirements :durative-actions :typing :fluents)
 (:types worker job)
 (:predicates (idle ?w - worker) (can ?w - worker ?j - job) (done ?j - job))
 (:functions (length ?j - job))
 (:durative-action work :parameters (?w - worker ?j - job) :duration (= ?duration (length ?j))
  :condition (and (at start (idle ?w)) (at start (can ?w ?j)))
  :effect (and (at start (not (idle ?w))) (at end (idle ?w)) (at start (done ?j)))))";
const PROBLEM: &str = "(define (problem p) (:domain jobs)
 (:objects slow quick - worker long a b c - job)
 (:init (idle slow) (idle quick) (can slow long) (can quick a) (can quick b) (can quick c)
  (= (length long) 100) (= (length a) 30) (= (length b) 20) (= (length c) 10))
 (:goal (and (done long) (done a) (done b) (done c))))";

fn jobs_of_quick(promptness: f64) -> (Vec<String>, f64, Outcome) {
    let (domain, problem) = support::read(DOMAIN, PROBLEM);
    let options = SolveOptions {
        promptness,
        ..support::options()
    };
    let report = support::solved(&domain, &problem, &NoAttachments, &options);
    for pair in report.plans.windows(2) {
        assert!(pair[1].cost < pair[0].cost, "plans must improve");
    }
    let best = report.plans.last().expect("a plan");
    let steps = best.plan.steps.iter();
    let quick = steps.filter(|step| step.arguments[0] == "quick");
    let jobs = quick.map(|step| step.arguments[1].clone()).collect();
    (jobs, best.cost, report.outcome)
}

#[test]
fn short_jobs_come_first() {
    let (jobs, cost, outcome) = jobs_of_quick(1.0);
    assert_eq!(jobs, ["c", "b", "a"]);
    // Ends at 100, and at 10, 30 and 60: the ends count, although the effects come at the start.
    assert!((cost - (100.0 + 200.0 / 4.0)).abs() < 0.1, "{cost}");
    assert_ne!(outcome, Outcome::SolvedOptimally, "nothing was proved");
}

#[test]
fn without_it_the_makespan_alone_counts() {
    let (_, cost, outcome) = jobs_of_quick(0.0);
    assert!((cost - 100.0).abs() < 0.1, "{cost}");
    assert_eq!(outcome, Outcome::SolvedOptimally);
}
