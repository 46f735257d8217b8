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

#[test]
fn computed_durations_are_found_where_a_problem_makes_them_impossible() {
    let bound = "(= ?duration (- (/ (distance ?a ?b) (speed)) (delay)))";
    let domain = DOMAIN
        .replace(
            "(:functions (distance ?a ?b - place))",
            "(:functions (distance ?a ?b - place) (speed) (delay))",
        )
        .replace(
            ":numeric-fluents",
            ":numeric-fluents :equality :negative-preconditions",
        )
        .replace("(= ?duration (distance ?a ?b))", bound);
    let with = |domain: &str, values: &str| {
        findings(domain, &PROBLEM.replace("(= (distance a b) 3)", values))
    };
    let values = "(= (distance a b) 8) (= (distance b a) 4)";
    let one_way = [format!("PDDL088 {bound}")];
    let fine = format!("{values} (= (speed) 2) (= (delay) 1)");
    assert_eq!(with(&domain, &fine), [""; 0]);
    let late = format!("{values} (= (speed) 2) (= (delay) 3)");
    assert_eq!(with(&domain, &late), one_way);
    let still = format!("{values} (= (speed) 0) (= (delay) 1)");
    assert_eq!(
        with(&domain, &still),
        [
            "PDDL091 go",
            &format!("PDDL094 {bound}"),
            "PDDL092 (at r b)",
            "PDDL092 (seen b)"
        ]
    );
    // What a condition excludes is no fault.
    let on_the_spot = format!("{fine} (= (distance b b) 1)");
    assert_eq!(with(&domain, &on_the_spot), one_way);
    let excluding = domain.replace(
        "(and (at start (at ?r ?a))",
        "(and (at start (at ?r ?a)) (at start (not (= ?a ?b)))",
    );
    assert_eq!(with(&excluding, &on_the_spot), [""; 0]);
}

/// Findings with another goal, in a problem with a second robot `s` that stands in `a`, and a
/// place `c` that no road leads to.
fn with_goal(goal: &str) -> Vec<String> {
    let domain = DOMAIN.replace(
        ":numeric-fluents",
        ":numeric-fluents :negative-preconditions :equality :universal-preconditions \
         :existential-preconditions :disjunctive-preconditions",
    );
    let problem = PROBLEM
        .replace("r - robot a b - place", "r s - robot a b c - place")
        .replace("(at r a)", "(at r a) (at s a) (seen a)")
        .replace("(and (at r b) (seen b))", goal);
    let mut found = findings(&domain, &problem);
    found.retain(|one| one.starts_with("PDDL09"));
    found
}

#[test]
fn quantified_and_negative_goals_are_examined() {
    for fine in [
        "(forall (?r - robot) (at ?r b))",
        "(exists (?p - place) (and (seen ?p) (not (= ?p a))))",
        "(not (at r a))",
        "(not (seen b))",
        "(imply (seen c) (at r c))",
        "(forall (?p - place) (or (= ?p c) (seen ?p)))",
        "(or (seen c) (at r b))",
    ] {
        assert_eq!(with_goal(fine), [""; 0], "{fine}");
    }
    for (goal, place) in [
        ("(forall (?p - place) (seen ?p))", "(seen ?p)"),
        ("(exists (?r - robot) (at ?r c))", "(at ?r c)"),
        ("(not (seen a))", "(seen a)"),
        ("(forall (?p - place) (not (seen ?p)))", "(seen ?p)"),
        ("(imply (seen a) (seen c))", "(seen c)"),
        (
            "(exists (?r ?s - robot) (and (= ?r ?s) (at ?r c)))",
            "(at ?r c)",
        ),
        ("(not (exists (?p - place) (seen ?p)))", "(seen ?p)"),
    ] {
        let found = with_goal(goal);
        assert!(
            found.contains(&format!("PDDL092 {place}")),
            "{goal}: {found:?}"
        );
        assert!(
            found.iter().all(|one| one.starts_with("PDDL092")),
            "{goal}: {found:?}"
        );
    }
    let nobody = "(exists (?p - place) (and (= ?p a) (= ?p b)))";
    assert_eq!(with_goal(nobody), [format!("PDDL092 {nobody}")]);
}

#[test]
fn a_quantified_goal_names_the_missing_fact() {
    let domain = SourceFile::new("d.pddl", DOMAIN);
    let text = PROBLEM
        .replace("a b - place", "a b c - place")
        .replace("(seen b)", "(forall (?p - place) (seen ?p))");
    let problem = SourceFile::new("p.pddl", text.as_str());
    let found = check_files(&domain, &[&problem], None);
    let goal: Vec<&str> = found[1]
        .iter()
        .filter(|one| one.code.number() == 92)
        .map(|one| one.message.as_str())
        .collect();
    assert_eq!(
        goal,
        ["`(seen c)` can never become true: the goal is out of reach"]
    );
}

#[test]
fn a_problem_too_large_to_be_examined_says_so() {
    let action = "(:action tie :parameters (?a - robot ?b ?c ?d ?e ?f ?g ?h)   :precondition (busy ?a) \
                  :effect (knot ?a ?b ?c ?d ?e ?f ?g ?h)))";
    let domain = DOMAIN
        .replace(
            "(busy ?r - robot))",
            "(busy ?r - robot) (knot ?a ?b ?c ?d ?e ?f ?g ?h))",
        )
        .trim_end()
        .strip_suffix(')')
        .unwrap()
        .to_owned()
        + action;
    let names: Vec<String> = (0..40).map(|index| format!("o{index}")).collect();
    let problem = PROBLEM
        .replace("a b - place", &format!("a b {} - place", names.join(" ")))
        .replace("(seen b)", "(seen b) (knot r a a a a a a a)");
    let mut found = findings(&domain, &problem);
    found.retain(|one| one.starts_with("PDDL09"));
    assert_eq!(found, ["PDDL095 x"]);
}
