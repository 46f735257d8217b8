//! Small tasks for the tests of heuristics.

use crate::attachment::NoAttachments;
use crate::grounding::{GroundingLimits, ground};
use crate::pddl::{read_domain, read_problem};
use crate::syntax::source::SourceFile;
use crate::task::Task;

/// Grounds a domain and a problem.
pub fn grounded(domain: &str, problem: &str) -> Task {
    let (domain, diagnostics) = read_domain(&SourceFile::new("domain", domain));
    let domain = domain.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let (problem, diagnostics) = read_problem(&SourceFile::new("problem", problem), &domain);
    let problem = problem.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let limits = GroundingLimits::default();
    ground(&domain, &problem, &NoAttachments, &limits).unwrap_or_else(|error| panic!("{error}"))
}

/// A truck at `a` brings a parcel from there to `b`, where the truck cannot be at first.
pub fn relay() -> Task {
    grounded(
        "(define (domain relay) (:requirements :typing :durative-actions)
 (:types vehicle place)
 (:predicates (at ?v - vehicle ?p - place) (parcel ?p - place) (in-vehicle ?v - vehicle))
 (:durative-action drive :parameters (?v - vehicle ?from ?to - place)
  :duration (= ?duration 5) :condition (at start (at ?v ?from))
  :effect (and (at start (not (at ?v ?from))) (at end (at ?v ?to))))
 (:durative-action load :parameters (?v - vehicle ?p - place)
  :duration (= ?duration 1)
  :condition (and (over all (at ?v ?p)) (at start (parcel ?p)))
  :effect (and (at start (not (parcel ?p))) (at end (in-vehicle ?v))))
 (:durative-action unload :parameters (?v - vehicle ?p - place)
  :duration (= ?duration 1)
  :condition (and (over all (at ?v ?p)) (at start (in-vehicle ?v)))
  :effect (and (at start (not (in-vehicle ?v))) (at end (parcel ?p)))))",
        "(define (problem p) (:domain relay) (:objects truck - vehicle a b - place)
 (:init (at truck a) (parcel a)) (:goal (parcel b)))",
    )
}
