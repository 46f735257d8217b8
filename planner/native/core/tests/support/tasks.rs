//! Small ground tasks.

#![allow(dead_code)] // each test takes what it needs

use std::fmt::Write as _;

use planner_core::attachment::NoAttachments;
use planner_core::grounding::{GroundingLimits, ground};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::syntax::source::SourceFile;
use planner_core::task::Task;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Grounds a domain and a problem.
pub fn grounded(domain: &str, problem: &str) -> Task {
    let (domain, diagnostics) = read_domain(&SourceFile::new("domain", domain));
    let domain = domain.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let (problem, diagnostics) = read_problem(&SourceFile::new("problem", problem), &domain);
    let problem = problem.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let limits = GroundingLimits::default();
    ground(&domain, &problem, &NoAttachments, &limits).unwrap()
}

/// Robots that drive, look and load their one charge.
pub const ROBOTS: &str = "(define (domain robots)
 (:requirements :typing :durative-actions :numeric-fluents)
 (:types robot place)
 (:predicates (at ?r - robot ?p - place) (seen ?p - place) (way ?a ?b - place))
 (:functions (charge))
 (:durative-action drive :parameters (?r - robot ?a ?b - place) :duration (= ?duration 8)
  :condition (and (at start (at ?r ?a)) (at start (way ?a ?b)))
  :effect (and (at start (not (at ?r ?a))) (at end (at ?r ?b))))
 (:durative-action look :parameters (?r - robot ?p - place) :duration (= ?duration 4)
  :condition (and (over all (at ?r ?p)) (at start (>= (charge) 3)))
  :effect (and (at start (decrease (charge) 3)) (at end (seen ?p))))
 (:durative-action load :parameters () :duration (= ?duration 2)
  :condition (at start (>= (charge) 0)) :effect (at end (increase (charge) 1))))";

/// Actions over few facts, some durative; conditions and effects at random.
pub fn random_task(seed: u64, facts: usize) -> Task {
    let random = &mut ChaCha8Rng::seed_from_u64(seed);
    let mut domain = String::from(
        "(define (domain random) (:requirements :adl :durative-actions)\n (:predicates",
    );
    for fact in 0..facts {
        write!(domain, " (p{fact})").unwrap();
    }
    domain += ")\n";
    let mut literal = |negative: u32| {
        let fact = random.random_range(0..facts);
        if random.random_range(0..10) < negative {
            format!("(not (p{fact}))")
        } else {
            format!("(p{fact})")
        }
    };
    for action in 0..2 * facts {
        let (need, also) = (literal(1), literal(1));
        let (give, take) = (literal(0), literal(9));
        if action % 2 == 0 {
            writeln!(
                domain,
                "(:action a{action} :parameters () :precondition (and {need} {also}) :effect (and {give} {take}))"
            )
        } else {
            writeln!(
                domain,
                "(:durative-action a{action} :parameters () :duration (= ?duration {})
                  :condition (and (at start {need}) (over all {also}))
                  :effect (and (at start {take}) (at end {give})))",
                1 + action % 3
            )
        }
        .unwrap();
    }
    let (first, second) = (literal(0), literal(0));
    let problem = format!(
        "(define (problem p) (:domain random) (:init (p0) (p1)) (:goal (and {first} {second})))"
    );
    grounded(&(domain + ")"), &problem)
}
