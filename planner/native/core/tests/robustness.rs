//! Hostile files: a diagnostic, never a crash, never a hang.

use planner_core::pddl::{read_domain, read_problem};
use planner_core::syntax::code::Code;
use planner_core::syntax::diagnostic::has_errors;
use planner_core::syntax::render::render_all;
use planner_core::syntax::source::SourceFile;
use proptest::prelude::*;

fn codes(text: impl Into<String>) -> Vec<Code> {
    let source = SourceFile::new("d.pddl", text.into());
    let (_, diagnostics) = read_domain(&source);
    // Rendering must cope with whatever was found.
    let _ = render_all(&diagnostics, &source, None);
    diagnostics
        .iter()
        .map(|diagnostic| diagnostic.code)
        .collect()
}

fn in_action(condition: &str) -> String {
    format!(
        "(define (domain d) (:requirements :adl :numeric-fluents) (:predicates (p)) (:functions (f))
         (:action a :parameters () :precondition {condition} :effect (p)))"
    )
}

#[test]
fn nesting_just_below_the_limit_is_read_on_a_small_stack() {
    let body = |open: &str, inner: &str| {
        let depth = 390;
        format!("{}{inner}{}", open.repeat(depth), ")".repeat(depth))
    };
    let texts = [
        in_action(&body("(and ", "(p)")),
        in_action(&body("(not ", "(p)")),
        in_action(&body("(forall (?x) ", "(p)")),
        in_action(&format!("(< 1 {})", body("(+ 1 ", "2"))),
        in_action("()").replace(
            ":effect (p)",
            &format!(":effect {}", body("(when (p) ", "(p)")),
        ),
    ];
    for text in texts {
        let handle = std::thread::Builder::new()
            .stack_size(1 << 20)
            .spawn(move || codes(text))
            .unwrap();
        assert_eq!(handle.join().unwrap(), []);
    }
}

#[test]
fn a_hundred_thousand_parentheses() {
    let open = "(".repeat(100_000);
    let closed = ")".repeat(100_000);
    for text in [
        open.clone(),
        closed.clone(),
        format!("{open}{closed}"),
        in_action(&open),
        in_action(&format!("{open}(p){closed}")),
        "[(".repeat(100_000),
        "([)]".repeat(100_000),
        "(:action ".repeat(100_000),
        "(define (domain d) ".repeat(50_000),
    ] {
        assert!(!codes(text).is_empty());
    }
}

#[test]
fn bytes_that_are_no_text() {
    for bytes in [
        &b"\xff\xfe\x00\x01"[..],
        b"(define (domain \0d))",
        b"\0",
        b"",
        b"\xef\xbb\xbf",
    ] {
        let source = SourceFile::from_bytes("d.pddl", bytes);
        let (_, diagnostics) = read_domain(&source);
        assert!(has_errors(&diagnostics), "{bytes:?}");
        let _ = render_all(&diagnostics, &source, None);
    }
}

#[test]
fn latin_letters_in_comments_are_only_a_warning() {
    let source = SourceFile::from_bytes("d.pddl", b"; M\xfcller\n(define (domain d))");
    let (domain, diagnostics) = read_domain(&source);
    assert!(domain.is_some() && !has_errors(&diagnostics));
    assert_eq!(diagnostics.len(), 1);
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let source = SourceFile::from_bytes("d.pddl", b"\xef\xbb\xbf(define (domain d))");
    let (_, diagnostics) = read_domain(&source);
    assert_eq!(diagnostics, []);
}

#[test]
fn ten_megabytes_of_faults_are_counted() {
    let chains: String = (0..300_000)
        .map(|i| format!("t{} - t{i} ", i + 1))
        .collect();
    let uses = "(p ?x - t299999 ?y - t0) (q ?x - t0 ?y - t299999)";
    let text = format!(
        "(define (domain d) (:requirements :typing) (:types t0 - object {chains}) (:predicates {uses})
         (:action a :parameters (?x - t3 ?y - t299999) :precondition (and (p ?y ?x) (q ?x ?y)) :effect (q ?x ?x)))"
    );
    codes(text);
    let text = format!(
        "(define (domain d) (:requirements {}))",
        ":nonsense ".repeat(1_000_000)
    );
    assert_eq!(codes(text).len(), 100);
    let text = format!(
        "(define (domain d) (:predicates (p {})))",
        "?x ".repeat(3_000_000)
    );
    assert!(codes(text).contains(&Code::TooManyMembers));
    let (domain, _) = read_domain(&SourceFile::new(
        "d",
        "(define (domain d) (:predicates (p ?x)))",
    ));
    let objects: String = (0..20_000).map(|i| format!("object{i} ")).collect();
    let text = format!(
        "(define (problem p) (:domain d) (:objects {objects}) (:init {}) (:goal (and)))",
        "(p obbject) ".repeat(500_000)
    );
    let (_, diagnostics) = read_problem(&SourceFile::new("p", text), &domain.unwrap());
    assert_eq!(diagnostics.len(), 100);
}

const VALID: &str = include_str!("files/everything.pddl");

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_read_to_the_end(text in "[\\PC\\x00\\n():?\\[\\];-]{0,200}") {
        codes(text);
    }

    #[test]
    fn a_mutated_domain_is_read_to_the_end(
        cuts in prop::collection::vec((0.0..1.0f64, 0..12usize, "[()\\[\\];: a-z?]{0,3}"), 1..6)
    ) {
        let mut characters: Vec<char> = VALID.chars().collect();
        for (place, length, inserted) in cuts {
            let start = (place * characters.len() as f64) as usize;
            let end = (start + length).min(characters.len());
            characters.splice(start..end, inserted.chars());
        }
        codes(characters.into_iter().collect::<String>());
    }
}
