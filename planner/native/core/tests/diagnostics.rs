//! Faults: code, place and remedy.

use planner_core::analysis::{Subject, check};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::plan::reader;
use planner_core::syntax::code::{Code, TABLE};
use planner_core::syntax::diagnostic::{Diagnostic, Severity, has_errors};
use planner_core::syntax::render::render;
use planner_core::syntax::source::SourceFile;

/// Everything that is found in a text; a line `;;; problem` parts domain and problem.
fn diagnose(text: &str) -> Vec<Diagnostic> {
    let (domain_text, problem_text) = match text.split_once("\n;;; problem\n") {
        Some((domain, problem)) => (domain, Some(problem)),
        None => (text, None),
    };
    let source = if domain_text.contains('\u{fffd}') {
        let bytes = domain_text.replace('\u{fffd}', "\u{1}").into_bytes();
        let bytes: Vec<u8> = bytes
            .into_iter()
            .map(|b| if b == 1 { 0xff } else { b })
            .collect();
        SourceFile::from_bytes("d.pddl", &bytes)
    } else {
        SourceFile::new("d.pddl", domain_text)
    };
    let (domain, mut diagnostics) = read_domain(&source);
    if let Some(domain) = domain.as_ref().filter(|_| !has_errors(&diagnostics)) {
        let problem = problem_text
            .map(|text| read_problem(&SourceFile::new("p.pddl", text), domain))
            .filter(|(_, diagnostics)| !has_errors(diagnostics))
            .and_then(|(problem, _)| problem);
        let findings = check(&Subject {
            domain,
            problems: &problem.iter().collect::<Vec<_>>(),
            providers: Some(&["pathCost".to_owned()]),
        });
        diagnostics.extend(findings.domain);
        diagnostics.extend(findings.problems.into_iter().flatten());
    }
    if let (Some(text), Some(domain)) = (problem_text, domain) {
        let (text, plan_text) = match text.split_once("\n;;; plan\n") {
            Some((problem, plan)) => (problem, Some(plan)),
            None => (text, None),
        };
        let (problem, more) = read_problem(&SourceFile::new("p.pddl", text), &domain);
        diagnostics.extend(more);
        if let (Some(text), Some(problem)) = (plan_text, problem) {
            let source = SourceFile::new("plan", text);
            diagnostics.extend(reader::read(&source, &domain, &problem).1);
        }
    }
    diagnostics
}

#[test]
fn every_example_of_the_table_gives_its_code() {
    // Examples that are too long to be written out.
    let long = [
        Code::NestedTooDeeply,
        Code::FileTooLarge,
        Code::TooManyMembers,
    ];
    let mut wrong = Vec::new();
    for entry in TABLE.iter().filter(|entry| !long.contains(&entry.code)) {
        let found = diagnose(entry.example);
        let own = found
            .iter()
            .find(|diagnostic| diagnostic.code == entry.code);
        if own.is_none_or(|own| own.severity != entry.severity) {
            wrong.push(format!("{} is not given: {found:?}", entry.code));
        }
        for other in &found {
            if other.code != entry.code && other.severity == Severity::Error {
                wrong.push(format!("{} gives {other:?} too", entry.code));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn all_faults_of_a_file_are_found_in_one_run() {
    let text = "(define (domain d)
  (:requirements :typing :durative-actions)
  (:types robot place)
  (:predicates (at ?r - robot ?p - plce) (clear ?p - place)
  (:durative-action go
    :parameters (?r - robot ?p - place)
    :duration (= ?duration (distance ?r))
    :condition (at start (at ?r ?q))
    :effect (and (at end (claer ?p)) (at ?r))))";
    let codes: Vec<Code> = diagnose(text)
        .iter()
        .map(|diagnostic| diagnostic.code)
        .collect();
    assert_eq!(
        codes,
        [
            Code::UnclosedParenthesis,
            Code::UnknownType,
            Code::UnknownFunction,
            Code::UnknownVariable,
            Code::UnknownPredicate,
            Code::MissingTime,
        ]
    );
}

#[test]
fn a_diagnostic_of_a_problem_shows_the_declaration_in_the_domain() {
    let domain_source = SourceFile::new(
        "domain.pddl",
        "(define (domain d)\n  (:requirements :typing)\n  (:types robot place)\n  (:predicates (at ?r - robot ?p - place)))\n",
    );
    let (domain, _) = read_domain(&domain_source);
    let source = SourceFile::new(
        "problem.pddl",
        "(define (problem p) (:domain d)\n  (:objects r1 - robot kitchen - place)\n  (:init (at kitchen kitchen))\n  (:goal (at r1 kichen)))\n",
    );
    let (problem, diagnostics) = read_problem(&source, &domain.unwrap());
    assert!(problem.is_some());
    let rendered: Vec<String> = diagnostics
        .iter()
        .map(|diagnostic| render(diagnostic, &source, Some(&domain_source)))
        .collect();
    let expected = "\
error[PDDL030]: `kitchen` is of type `place`, `at` wants `robot` here
 --> problem.pddl:3:14
  |
3 |   (:init (at kitchen kitchen))
  |              ^^^^^^^ of a type that does not fit
 ::: domain.pddl:4:20
  |
4 |   (:predicates (at ?r - robot ?p - place)))
  |                    -- `?r` is declared as `robot`
  = help: use something of type `robot`, or widen the declaration
error[PDDL023]: unknown object `kichen`
 --> problem.pddl:4:16
  |
4 |   (:goal (at r1 kichen)))
  |                 ^^^^^^ neither an object nor a constant
  = help: did you mean `kitchen`?
";
    assert_eq!(rendered.concat(), expected.replace(":4:16", ":4:17"));
}

#[test]
fn fixes_mend_what_they_are_given_for() {
    let texts = [
        "(define (domain d) (:predicates (p)) (:action a :parameters () :precondition (not (p)) :effect (p)))",
        "(define (domain d) (:requirements :strips) (:predicates (p)) (:action a :parameters () :precondition (not (p)) :effect (p)))",
        "(define (domain d) (:requirements :durative-actions) (:predicates (p)) (:durative-action a :parameters () :duration (= ?duration 1) :condition (p) :effect (at end (p))))",
        "(define (domain d) (:predicates (cleared)) (:action a :parameters () :effect (claered)))",
        "(define (domain d) (:predicates (p)",
        "(define (domain d) (:predicates (p))))",
    ];
    for text in texts {
        let mut mended = text.to_owned();
        for _ in 0..4 {
            let diagnostics = diagnose(&mended);
            let Some(fix) = diagnostics.iter().find_map(|d| d.fix.clone()) else {
                break;
            };
            let mut edits = fix.edits;
            edits.sort_by_key(|edit| std::cmp::Reverse(edit.span));
            for edit in edits {
                let range = edit.span.start as usize..edit.span.end as usize;
                mended.replace_range(range, &edit.replacement);
            }
        }
        let mut left = diagnose(&mended);
        left.retain(|diagnostic| diagnostic.code != Code::UnusedDeclaration);
        assert_eq!(left, [], "{text} became {mended}");
    }
}
