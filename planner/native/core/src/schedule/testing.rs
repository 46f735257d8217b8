//! A small task for the tests of this space, and what they all need.

use crate::attachment::NoAttachments;
use crate::grounding::{GroundingLimits, ground};
use crate::pddl::{read_domain, read_problem};
use crate::schedule::links::{Element, Links};
use crate::schedule::workshop::Workshop;
use crate::syntax::source::SourceFile;
use crate::task::{OperatorId, Task};

/// Prime, then paint, then pack; sweeping is independent.
pub const FACTORY: &str = "(define (domain factory) (:requirements :durative-actions)
 (:predicates (raw) (primed) (painted) (packed) (swept) (dusty) (clean))
 (:durative-action prime :parameters () :duration (= ?duration 4)
  :condition (at start (raw)) :effect (and (at start (not (raw))) (at end (primed))))
 (:durative-action paint :parameters () :duration (= ?duration 3)
  :condition (at start (primed)) :effect (and (at start (painted)) (at end (swept))))
 (:durative-action pack :parameters () :duration (= ?duration 2)
  :condition (at start (painted)) :effect (at end (packed)))
 (:durative-action sweep :parameters () :duration (= ?duration 1)
  :condition (at start (dusty)) 
  :effect (and (at start (not (dusty))) (at end (clean)))))";

/// Grounds a domain for the goal of a swept and packed factory.
pub fn task(domain: &str) -> Task {
    ground_texts(
        domain,
        "(define (problem p) (:domain factory) (:init (raw) (dusty))
     (:goal (and (packed) (swept) (clean))))",
    )
}

/// Grounds a domain and a problem.
pub fn ground_texts(domain: &str, problem: &str) -> Task {
    let (domain, diagnostics) = read_domain(&SourceFile::new("domain", domain));
    let domain = domain.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let (problem, diagnostics) = read_problem(&SourceFile::new("problem", problem), &domain);
    let problem = problem.unwrap_or_else(|| panic!("{diagnostics:?}"));
    ground(
        &domain,
        &problem,
        &NoAttachments,
        &GroundingLimits::default(),
    )
    .unwrap_or_else(|error| panic!("{error}"))
}

/// The operator of a name.
pub fn operator(task: &Task, name: &str) -> u32 {
    let mut operators = 0..task.operators.len() as u32;
    let found = operators.find(|index| task.operator_name(OperatorId(*index)) == name);
    found.unwrap_or_else(|| panic!("no operator {name}"))
}

/// A list of operators by name, and what each of them is for.
pub fn elements(task: &Task, workshop: &Workshop, names: &[&str]) -> Vec<Element> {
    let list: Vec<u32> = names.iter().map(|name| operator(task, name)).collect();
    let (model, propositions) = (&workshop.model, &workshop.propositions);
    Links::default().elements(model, propositions, &list, true)
}
