//! The formatter: worked examples and its laws.

use std::fs;
use std::path::{Path, PathBuf};

use planner_core::format::{WIDTH, format};
use planner_core::syntax::lexer::TokenKind;
use planner_core::syntax::source::SourceFile;
use planner_core::syntax::tree::Tree;
use proptest::prelude::*;

/// Everything but white space.
fn content(text: &str) -> Vec<String> {
    let tree = Tree::new(&SourceFile::new("t.pddl", text));
    let tokens = tree.tokens();
    (0..tokens.len())
        .filter(|&token| tokens.kinds[token] != TokenKind::WhiteSpace)
        .map(|token| {
            let span = tokens.span(token);
            text[span.start as usize..span.end as usize]
                .trim_end()
                .to_owned()
        })
        .collect()
}

fn formatted(text: &str) -> String {
    format(&SourceFile::new("t.pddl", text)).unwrap()
}

/// Both laws: nothing but white space changes, and once is enough.
fn check_laws(text: &str) -> String {
    let once = formatted(text);
    assert_eq!(content(&once), content(text), "{text}\n---\n{once}");
    assert_eq!(formatted(&once), once, "{text}");
    once
}

#[test]
fn a_domain() {
    let text = "; explorers
(define (domain d) (:requirements :typing :durative-actions) (:types robot location - object mission_target
- location)


(:predicates (at ?r - robot ?l - location) ; where it is
(explored ?t - mission_target))
(:constants home base - location)
; drive
(:durative-action move :parameters (?r - robot ?from ?to - location)
:duration (= ?duration [pathCost ?r ?from ?to])
:condition (and (at start (at ?r ?from)) (over all (forall (?o - robot) (imply (not (= ?o ?r)) (not (at ?o ?to))))))
:effect (and (at start (not (at ?r ?from))) (at end (at ?r ?to))
; arrived
))
(:action wait :parameters ())
)";
    let expected = "\
; explorers
(define (domain d)
  (:requirements :typing :durative-actions)
  (:types robot location - object mission_target - location)

  (:predicates
    (at ?r - robot ?l - location) ; where it is
    (explored ?t - mission_target))
  (:constants home base - location)

  ; drive
  (:durative-action move
    :parameters (?r - robot ?from ?to - location)
    :duration (= ?duration [pathCost ?r ?from ?to])
    :condition (and
      (at start (at ?r ?from))
      (over all (forall (?o - robot) (imply (not (= ?o ?r)) (not (at ?o ?to))))))
    :effect (and
      (at start (not (at ?r ?from)))
      (at end (at ?r ?to))
      ; arrived
    ))

  (:action wait
    :parameters ()))
";
    assert_eq!(check_laws(text), expected);
}

#[test]
fn long_lists_of_objects_stand_one_type_a_line() {
    let names: String = (0..30).map(|i| format!("object{i} ")).collect();
    let text = format!(
        "(define (problem p) (:domain d) (:objects {names} - robot a b - place)\n(:init (p)) (:goal (q)))"
    );
    let once = check_laws(&text);
    assert!(once.contains("\n    a b - place)\n"), "{once}");
    assert!(
        once.lines().all(|line| line.chars().count() <= WIDTH),
        "{once}"
    );
}

#[test]
fn faulty_files_are_refused() {
    let diagnostics = format(&SourceFile::new("t.pddl", "(define (domain d)")).unwrap_err();
    assert_eq!(diagnostics.len(), 1);
}

#[test]
fn small_cases() {
    for text in [
        "",
        "a",
        "()",
        "( ; c\n)",
        "; c",
        "(a ; b\n c ; d\n)",
        "(a\n\n\n; b\n\n(c))",
        "[]",
    ] {
        check_laws(text);
    }
    assert_eq!(check_laws("( a\n b [ c ] )\r\n"), "(a b [c])\n");
}

fn pddl_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            pddl_files(&path, found);
        } else if path
            .extension()
            .is_some_and(|extension| extension == "pddl")
        {
            found.push(path);
        }
    }
}

#[test]
fn all_files_at_hand_obey_the_laws() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    let mut files = Vec::new();
    for folder in [
        "domains",
        "planner/native/core/tests/files",
        "../shared/data/ipc",
        "../shared/data/instances",
    ] {
        pddl_files(&root.join(folder), &mut files);
    }
    assert!(!files.is_empty());
    if files.len() < 100 {
        eprintln!("the competition suites in ../shared/data are absent: fewer files are tried");
    }
    for file in files {
        if let Ok(text) = String::from_utf8(fs::read(&file).unwrap())
            && format(&SourceFile::new("t.pddl", text.as_str())).is_ok()
        {
            check_laws(&text);
        }
    }
}

fn expressions() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        "[a-z?:-]{1,12}",
        Just("-".to_owned()),
        "; [a-z ]{0,10}\n".prop_map(|comment| comment),
        "\n{0,3}".prop_map(|blank| format!(" {blank} ")),
    ];
    leaf.prop_recursive(6, 120, 9, |inner| {
        let head = prop_oneof![
            Just(""),
            Just("define"),
            Just("and"),
            Just("forall"),
            Just(":action"),
            Just(":objects"),
            Just(":predicates"),
            Just(":init"),
            Just("at start"),
            Just("\n; c\n"),
        ];
        (head, prop::collection::vec(inner, 0..9), any::<bool>()).prop_map(
            |(head, parts, round)| {
                let body = parts.join(" ");
                if round {
                    format!("({head} {body})")
                } else {
                    format!("[{body}]")
                }
            },
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_trees_obey_the_laws(text in expressions()) {
        if format(&SourceFile::new("t.pddl", text.as_str())).is_ok() {
            check_laws(&text);
        }
    }
}
