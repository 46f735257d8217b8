//! Plan text: the variants in use, faults with their places, and the law that writing and reading is identity.

use planner_core::pddl::model::{Domain, Problem};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::plan::writer::{Surroundings, write};
use planner_core::plan::{Plan, Step, reader};
use planner_core::syntax::code::TABLE;
use planner_core::syntax::diagnostic::Diagnostic;
use planner_core::syntax::render::render_all;
use planner_core::syntax::source::SourceFile;
use proptest::prelude::*;

const DOMAIN: &str = "(define (domain d) (:requirements :typing :durative-actions)
  (:types robot place - object) (:predicates (at ?r - robot ?p - place))
  (:durative-action drive :parameters (?r - robot ?a ?b - place) :duration (>= ?duration 0)
   :condition () :effect (at end (at ?r ?b)))
  (:action ring :parameters () :effect (and)))";
const PROBLEM: &str =
    "(define (problem p) (:domain d) (:objects r1 r2 - robot a b-2 - place) (:init) (:goal (and)))";

fn task() -> (Domain, Problem) {
    let domain = read_domain(&SourceFile::new("d.pddl", DOMAIN)).0.unwrap();
    let problem = read_problem(&SourceFile::new("p.pddl", PROBLEM), &domain)
        .0
        .unwrap();
    (domain, problem)
}

fn read(text: &str) -> (Option<Plan>, Vec<Diagnostic>) {
    let (domain, problem) = task();
    reader::read(&SourceFile::new("plan", text), &domain, &problem)
}

fn drive(start: f64, duration: f64) -> Step {
    Step {
        start,
        action: "drive".into(),
        arguments: vec!["r1".into(), "a".into(), "b-2".into()],
        duration: Some(duration),
    }
}

#[test]
fn all_variants_give_the_same_plan() {
    let expected = Plan {
        steps: vec![drive(0.0, 5.0)],
    };
    for text in [
        "0.000: (drive r1 a b-2) [5.000]",
        "0: (drive r1 a b-2)[5]",
        "0:(drive r1 a b-2)[5]",
        "0.0 : ( drive r1 a b-2 ) [ 5.0 ]",
        "0.00000000: (DRIVE R1 A B-2) [5.00000000]",
        ";;!domain: d\n;;!problem: p\n; Makespan: 5\n0: (drive r1 a b-2) [5] ; a comment\n; Metric: 5",
        "0.0: (drive r1 a b-2) [D:5.00; C:0.10]",
        "0e0: (drive r1 a b-2) [5e0]\r\n",
        "0:\n(drive r1\n a b-2)\n[5]\n\n",
    ] {
        let (plan, diagnostics) = read(text);
        assert!(diagnostics.is_empty(), "{text}: {diagnostics:?}");
        assert_eq!(plan.as_ref(), Some(&expected), "{text}");
    }
}

#[test]
fn steps_are_sorted_and_steps_without_time_follow_one_another() {
    let (plan, _) = read("7: (ring) 0: (drive r1 a b-2)[5]");
    let starts: Vec<f64> = plan.unwrap().steps.iter().map(|step| step.start).collect();
    assert_eq!(starts, [0.0, 7.0]);
    let (plan, _) = read("(ring) (ring) (ring)");
    let starts: Vec<f64> = plan.unwrap().steps.iter().map(|step| step.start).collect();
    assert_eq!(starts, [1.0, 2.0, 3.0]);
}

#[test]
fn an_instantaneous_step_may_say_that_it_lasts_nothing() {
    let (plan, diagnostics) = read("1: (ring) [0.000]");
    assert!(diagnostics.is_empty());
    assert_eq!(plan.unwrap().steps[0].duration, None);
}

#[test]
fn every_fault_of_a_plan_is_shown_at_its_place() {
    let text = "\
0: (driv r1 a b-2) [5]
1: (drive r1 a) [5]
2: (drive r3 a b-2) [5]
3: (drive a a b-2) [5]
4: (drive r1 a b-2)
5: (ring) [5]
-1: (ring)
no plan found
x: (ring)
6: (drive r1 a b-2 [5]
7: () [5]
8: (drive r1 a b-2) [5.0.0]
9: (ring)
10: (drive r1 a b-2) [
";
    let (plan, diagnostics) = read(text);
    assert_eq!(plan, None);
    let source = SourceFile::new("plan", text);
    let found: Vec<(u32, String)> = diagnostics
        .iter()
        .map(|one| {
            let place = source.lines().position(text, one.span.start);
            (place.line + 1, one.code.to_string())
        })
        .collect();
    let found: Vec<(u32, &str)> = found
        .iter()
        .map(|(line, code)| (*line, code.as_str()))
        .collect();
    assert_eq!(
        found,
        [
            (1, "PDDL071"),
            (2, "PDDL029"),
            (3, "PDDL023"),
            (4, "PDDL030"),
            (5, "PDDL072"),
            (6, "PDDL072"),
            (7, "PDDL070"),
            (8, "PDDL070"),
            (9, "PDDL070"),
            (10, "PDDL070"),
            (11, "PDDL070"),
            (12, "PDDL070"),
            (14, "PDDL070"),
        ],
        "{}",
        render_all(&diagnostics, &source, None)
    );
    let first = render_all(&diagnostics[..1], &source, None);
    assert_eq!(
        first,
        "\
error[PDDL071]: the domain has no action driv
 --> plan:1:5
  |
1 | 0: (driv r1 a b-2) [5]
  |     ^^^^ no such action
  = help: did you mean `drive`?
"
    );
}

#[test]
fn bytes_that_are_no_text_are_a_diagnostic() {
    let (domain, problem) = task();
    let source = SourceFile::from_bytes("plan", b"0: (ring)\n\xff\xfe\0");
    let (plan, diagnostics) = reader::read(&source, &domain, &problem);
    assert_eq!(plan, None);
    assert_eq!(diagnostics[0].code.to_string(), "PDDL004");
}

#[test]
fn the_examples_in_the_table_give_their_codes() {
    let mut tried = 0;
    for entry in TABLE {
        let Some((files, plan)) = entry.example.split_once(";;; plan\n") else {
            continue;
        };
        let (domain, problem) = files.split_once(";;; problem\n").unwrap();
        let domain = read_domain(&SourceFile::new("d.pddl", domain)).0.unwrap();
        let problem = read_problem(&SourceFile::new("p.pddl", problem), &domain)
            .0
            .unwrap();
        let (_, diagnostics) = reader::read(&SourceFile::new("plan", plan), &domain, &problem);
        let codes: Vec<_> = diagnostics.iter().map(|one| one.code).collect();
        assert_eq!(codes, [entry.code], "{}", entry.example);
        tried += 1;
    }
    assert_eq!(tried, 3);
}

proptest! {
    #[test]
    fn what_is_written_reads_back(
        times in proptest::collection::vec((0.0..1e6_f64, 0.0..1e4_f64), 0..20),
        metric in proptest::option::of(-1e3..1e3_f64),
    ) {
        let mut steps: Vec<Step> = times.into_iter().map(|(start, duration)| drive(start, duration)).collect();
        steps.sort_by(|left, right| left.start.total_cmp(&right.start));
        let plan = Plan { steps };
        let around = Surroundings { domain: Some("d"), problem: Some("p"), evaluated: Some(3), metric };
        let (again, diagnostics) = read(&write(&plan, &around));
        prop_assert!(diagnostics.is_empty());
        prop_assert_eq!(again, Some(plan));
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in "[0-9a-z:();\\[\\] .\\n-]{0,60}") {
        let (plan, diagnostics) = read(&text);
        prop_assert!(plan.is_some() || !diagnostics.is_empty());
    }
}
