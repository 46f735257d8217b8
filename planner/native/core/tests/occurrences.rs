//! Occurrences of symbols and their declarations.

use planner_core::analysis::{SymbolKind, occurrences};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::syntax::source::SourceFile;
use planner_core::syntax::tree::Tree;

const DOMAIN: &str = "(define (domain d) (:types robot place - object)
  (:predicates (at ?r - robot ?p - place)) (:functions (fuel ?r - robot))
  (:action go :parameters (?r - robot ?p - place)
    :precondition (forall (?r - robot) (at ?r ?p)) :effect (and (at ?r ?p) (assign (fuel ?r) 1))))";

#[test]
fn an_inner_variable_is_not_the_outer_one() {
    let source = SourceFile::new("d.pddl", DOMAIN);
    let (domain, _) = read_domain(&source);
    let all = occurrences(&Tree::new(&source), domain.as_ref(), None);
    let robots: Vec<(u32, bool)> = all
        .iter()
        .filter(|one| one.kind == SymbolKind::Variable && one.name == "?r")
        .map(|one| (one.scope, one.definition))
        .collect();
    let action = DOMAIN.find("(:action").unwrap() as u32;
    let forall = DOMAIN.find("(forall").unwrap() as u32;
    assert_eq!(
        robots[2..],
        [
            (action, true),
            (forall, true),
            (forall, false),
            (action, false),
            (action, false)
        ]
    );
    for one in &all {
        assert_eq!(source.slice(one.span).to_ascii_lowercase(), one.name);
    }
    let types = all
        .iter()
        .filter(|one| one.kind == SymbolKind::Type && one.name == "robot");
    assert_eq!(types.count(), 5);
}

#[test]
fn a_problem_refers_to_its_domain() {
    let (domain, _) = read_domain(&SourceFile::new("d.pddl", DOMAIN));
    let source = SourceFile::new(
        "p.pddl",
        "(define (problem x) (:domain d) (:objects r1 - robot k - place) (:init (at r1 k) (= (fuel r1) 2)) (:goal (at R1 k)))",
    );
    let (problem, _) = read_problem(&source, domain.as_ref().unwrap());
    let all = occurrences(&Tree::new(&source), domain.as_ref(), problem.as_ref());
    let robot = all.iter().filter(|one| one.name == "r1");
    assert_eq!(
        robot.map(|one| one.definition).collect::<Vec<_>>(),
        [true, false, false, false]
    );
    let count = |kind| all.iter().filter(|one| one.kind == kind).count();
    assert_eq!(count(SymbolKind::Predicate), 2);
    assert_eq!(count(SymbolKind::Function), 1);
    assert_eq!(count(SymbolKind::Domain), 1);
}
