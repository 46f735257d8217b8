//! Limits hold where nothing is found for long.

mod support;

use std::time::Duration;

use planner_core::attachment::NoAttachments;
use planner_core::outcome::Outcome;
use planner_core::pddl::model::{Domain, Problem};
use planner_core::solve::SolveOptions;
use support::{read, solved};

/// Sixteen different seats on fifteen chairs: some 10^12 arrangements to look at, none of which
/// completes.
#[test]
fn a_join_that_completes_nothing_keeps_to_the_time() {
    let seats: Vec<String> = (0..16).map(|k| format!("?s{k}")).collect();
    let mut apart = String::new();
    for (k, one) in seats.iter().enumerate() {
        for other in &seats[..k] {
            apart += &format!("(not (= {one} {other}))");
        }
    }
    let domain = format!(
        "(define (domain party) (:requirements :typing :equality :negative-preconditions)
         (:types chair) (:predicates (seated))
         (:action seat :parameters ({} - chair) :precondition (and {apart}) :effect (seated)))",
        seats.join(" ")
    );
    let chairs: Vec<String> = (0..15).map(|k| format!("c{k}")).collect();
    let problem = format!(
        "(define (problem p) (:domain party) (:objects {} - chair) (:init) (:goal (seated)))",
        chairs.join(" ")
    );
    let (domain, problem) = read(&domain, &problem);
    let options = SolveOptions {
        timeout: Some(Duration::from_millis(50)),
        ..SolveOptions::default()
    };
    let report = solved(&domain, &problem, &NoAttachments, &options);
    assert_eq!(report.outcome, Outcome::TimedOut);
}

/// Twenty thousand operators take more than four megabytes.
#[test]
fn operators_that_do_not_fit_are_told() {
    let (domain, problem) = grid(20_000);
    let options = SolveOptions {
        memory_limit: 4 << 20,
        ..SolveOptions::default()
    };
    let report = solved(&domain, &problem, &NoAttachments, &options);
    assert_eq!(report.outcome, Outcome::OutOfMemory);
}

/// A ring of places, each of which leads to ten others.
fn grid(operators: usize) -> (Domain, Problem) {
    let places = operators / 10;
    let mut objects = String::new();
    let mut init = String::from("(at p0)");
    for place in 0..places {
        objects += &format!("p{place} ");
        for step in 1..=10 {
            init += &format!("(way p{place} p{})", (place + step) % places);
        }
    }
    read(
        "(define (domain ring) (:predicates (at ?x) (way ?x ?y))
         (:action go :parameters (?x ?y) :precondition (and (at ?x) (way ?x ?y))
          :effect (and (not (at ?x)) (at ?y))))",
        &format!(
            "(define (problem p) (:domain ring) (:objects {objects}) (:init {init}) (:goal (at p{})))",
            places / 2
        ),
    )
}
