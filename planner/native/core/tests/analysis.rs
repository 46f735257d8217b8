//! Checks beyond syntax: what they find, and what they must not find.

use planner_core::analysis::check_files;
use planner_core::syntax::source::SourceFile;

const DOMAIN: &str = "(define (domain d)
  (:requirements :typing :durative-actions :numeric-fluents)
  (:types robot place)
  (:predicates (at ?r - robot ?p - place) (seen ?p - place) (busy ?r - robot))
  (:functions (distance ?a ?b - place))
  (:durative-action go
    :parameters (?r - robot ?a ?b - place)
    :duration (= ?duration (distance ?a ?b))
    :condition (and (at start (at ?r ?a)) (over all (busy ?r)))
    :effect (and (at start (not (at ?r ?a))) (at start (busy ?r)) (at end (not (busy ?r))) (at end (at ?r ?b))))
  (:durative-action look
    :parameters (?r - robot ?p - place)
    :duration (= ?duration 2)
    :condition (over all (at ?r ?p))
    :effect (at end (seen ?p))))";
const PROBLEM: &str = "(define (problem x) (:domain d)
  (:objects r - robot a b - place)
  (:init (at r a) (= (distance a b) 3))
  (:goal (and (at r b) (seen b))))";

/// Code and text of every finding, in the domain and in the problem.
fn findings(domain: &str, problem: &str) -> Vec<String> {
    let domain = SourceFile::new("d.pddl", domain);
    let problem = SourceFile::new("p.pddl", problem);
    let found = check_files(&domain, &[&problem], None);
    [(&domain, &found[0]), (&problem, &found[1])]
        .into_iter()
        .flat_map(|(file, list)| {
            list.iter()
                .map(|one| format!("{} {}", one.code, file.slice(one.span)))
        })
        .collect()
}

/// Findings after one replacement in the domain or the problem.
fn after(written: &str, changed: &str) -> Vec<String> {
    let both = format!("{DOMAIN}@{PROBLEM}");
    assert_eq!(both.matches(written).count(), 1, "{written}");
    let both = both.replace(written, changed);
    let (domain, problem) = both.split_once('@').unwrap();
    findings(domain, problem)
}

#[test]
fn a_sound_pair_of_files_has_no_findings() {
    assert_eq!(findings(DOMAIN, PROBLEM), [""; 0]);
}

#[test]
fn a_start_effect_may_supply_the_over_all_condition() {
    // `busy` is true nowhere before `go` itself sets it.
    assert_eq!(
        after(
            "(at start (busy ?r)) (at end (not (busy ?r)))",
            "(at end (not (busy ?r)))"
        ),
        [
            "PDDL084 busy",
            "PDDL091 go",
            "PDDL092 (at r b)",
            "PDDL092 (seen b)"
        ]
    );
}

#[test]
fn a_goal_out_of_reach_is_named_with_the_missing_fact() {
    assert_eq!(
        after("(= (distance a b) 3)", ""),
        ["PDDL091 go", "PDDL092 (at r b)", "PDDL092 (seen b)"]
    );
}

#[test]
fn zero_and_negative_durations_are_found_where_a_problem_makes_them() {
    assert_eq!(
        after(
            "(= (distance a b) 3)",
            "(= (distance a b) 3) (= (distance b b) 0)"
        ),
        ["PDDL087 (= ?duration (distance ?a ?b))"]
    );
    assert_eq!(
        after(
            "(= (distance a b) 3)",
            "(= (distance a b) 3) (= (distance b a) -1)"
        ),
        ["PDDL088 (distance b a)"]
    );
}

#[test]
fn objects_and_variables_without_use() {
    assert_eq!(after("r - robot a b", "r - robot a b c"), ["PDDL082 c"]);
    assert_eq!(
        after(
            "(?r - robot ?p - place)\n    :duration (= ?duration 2)",
            "(?r - robot ?p ?q - place)\n    :duration (= ?duration 2)"
        ),
        ["PDDL081 ?q"]
    );
}

#[test]
fn attachments_may_read_what_nothing_else_does() {
    let modules = "(:modules (cost ?r - robot cost f@l))";
    let domain = DOMAIN
        .replace(
            "(:functions (distance ?a ?b - place))",
            &format!("(:functions (distance ?a ?b - place) (x ?p - place)) {modules}"),
        )
        .replace("(= ?duration 2)", "(= ?duration [cost ?r])");
    assert_eq!(
        findings(
            &domain,
            &PROBLEM.replace("(at r a)", "(at r a) (= (x a) 1)")
        ),
        [""; 0]
    );
    assert_eq!(findings(&domain, PROBLEM), ["PDDL080 x"]);
}

#[test]
fn an_attachment_is_assumed_to_help() {
    let domain = DOMAIN.replace(
        "(:functions",
        "(:modules (free ?p - place conditionchecker f@l))\n  (:functions",
    );
    for condition in ["([free ?p])", "(not ([free ?p]))"] {
        let domain = domain
            .replace(
                "(over all (at ?r ?p))",
                &format!("(and (over all (at ?r ?p)) (at start {condition}))"),
            )
            .replace(":typing", ":typing :negative-preconditions");
        assert_eq!(findings(&domain, PROBLEM), [""; 0]);
    }
}
