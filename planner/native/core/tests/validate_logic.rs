//! The validator on quantifiers, conditional effects, timed literals, derived facts, attachments.

#[path = "support/validation.rs"]
mod validation;

use planner_core::attachment::{Arguments, Attachments, Purity, StateView};
use planner_core::pddl::model::{FunctionId, ModuleId, ObjectId};
use planner_core::pddl::read_problem;
use planner_core::syntax::source::SourceFile;
use planner_core::validate::Options;
use validation::{Case, case};

/// Quantifiers, conditional effects, disjunctions.
fn logic() -> Case {
    case(
        "(define (domain logic)
          (:requirements :adl :typing :durative-actions)
          (:types box - object)
          (:predicates (open ?b - box) (full ?b - box) (marked ?b - box) (lit) (ok))
          (:action open-all :parameters ()
           :effect (forall (?b - box) (when (full ?b) (open ?b))))
          (:action swap :parameters (?a ?b - box)
           :precondition (and (not (= ?a ?b)) (or (full ?a) (full ?b)))
           :effect (and (when (full ?a) (and (not (full ?a)) (full ?b)))
                        (when (full ?b) (and (not (full ?b)) (full ?a)))))
          (:action finish :parameters ()
           :precondition (and (forall (?b - box) (imply (full ?b) (open ?b))) (exists (?b - box) (open ?b)))
           :effect (ok))
          (:durative-action watch :parameters ()
           :duration (= ?duration 10)
           :condition ()
           :effect (and (forall (?b - box) (when (and (at start (full ?b)) (over all (lit)) (at end (open ?b)))
                                                 (at end (marked ?b))))))
          (:action dark :parameters () :effect (not (lit)))
          (:action light :parameters () :effect (lit)))",
        "(define (problem p) (:domain logic) (:objects a b c - box)
          (:init (full a) (full b) (lit)) (:goal (and)))",
    )
}

#[test]
fn a_false_quantified_condition_names_its_exception() {
    let (code, message) = logic().rejected("1: (finish)");
    assert_eq!(code, "condition");
    assert!(message.contains("(imply (full a) (open a))"), "{message}");
    logic().accepted("1: (open-all) 2: (finish)");
}

#[test]
fn conditional_effects_look_at_the_state_before() {
    // Only a is full: after the swap only c is, so finishing needs c open alone.
    let case = logic();
    case.accepted("1: (swap a c) 2: (open-all) 3: (finish)");
    let (code, _) = case.rejected("1: (open-all) 2: (swap a c) 3: (finish)");
    assert_eq!(code, "condition");
}

#[test]
fn an_inequality_of_objects_is_checked() {
    let (_, message) = logic().rejected("1: (swap a a)");
    assert!(message.contains("(not (= a a))"), "{message}");
}

#[test]
fn effects_with_conditions_over_the_interval_follow_it() {
    let case = logic();
    let marked = |plan: &str| {
        let text = "(define (problem p) (:domain logic) (:objects a b c - box)
              (:init (full a) (full b) (lit)) (:goal (marked a)))";
        let source = SourceFile::new("p.pddl", text);
        let problem = read_problem(&source, &case.domain).0.unwrap();
        Case {
            domain: case.domain.clone(),
            problem,
        }
        .verdict(plan)
        .valid()
    };
    assert!(marked("0: (watch)[10] 5: (open-all)"));
    assert!(!marked("0: (watch)[10]"), "not open at end");
    assert!(
        !marked("0: (watch)[10] 4: (dark) 5: (open-all) 6: (light)"),
        "dark in between"
    );
    assert!(
        !marked("0: (swap a c) 1: (watch)[10] 2: (swap a c) 3: (open-all)"),
        "not full at start"
    );
}

/// Timed initial literals and derived predicates.
fn windows() -> Case {
    case(
        "(define (domain windows)
          (:requirements :typing :durative-actions :timed-initial-literals :derived-predicates :negative-preconditions)
          (:types place - object)
          (:predicates (open) (next ?a ?b - place) (at ?p - place) (reachable ?p - place) (stuck ?p - place) (done))
          (:derived (reachable ?p - place)
            (or (at ?p) (exists (?q - place) (and (reachable ?q) (next ?q ?p)))))
          (:derived (stuck ?p - place) (not (reachable ?p)))
          (:durative-action pass :parameters (?p - place)
           :duration (= ?duration 2)
           :condition (and (over all (open)) (at start (reachable ?p)))
           :effect (at end (done)))
          (:action cut :parameters (?a ?b - place) :effect (not (next ?a ?b))))",
        "(define (problem p) (:domain windows) (:objects a b c d - place)
          (:init (at a) (next a b) (next b c) (at 5 (open)) (at 10 (not (open)))) (:goal (done)))",
    )
}

#[test]
fn a_window_opens_and_closes() {
    let case = windows();
    case.accepted("6: (pass c)[2]");
    case.accepted("5: (pass c)[2]");
    case.accepted("8: (pass c)[2]");
    assert_eq!(case.rejected("4: (pass c)[2]").0, "condition");
    let (_, message) = case.rejected("9: (pass c)[2]");
    assert!(
        message.contains("(open) is false since 10 (timed initial literal)"),
        "{message}"
    );
}

#[test]
fn derived_facts_follow_the_state() {
    let case = windows();
    assert_eq!(case.rejected("6: (pass d)[2]").0, "condition");
    assert_eq!(case.rejected("1: (cut b c) 6: (pass c)[2]").0, "condition");
    case.accepted("1: (cut b c) 6: (pass b)[2]");
    // Deleting what a derived fact rests on interferes with whoever needs that fact.
    assert_eq!(
        case.rejected("6: (pass c)[2] 6: (cut b c)").0,
        "interference"
    );
}

/// Attachments of all three kinds, one of which reads the state.
struct Modules;

impl Attachments for Modules {
    fn purity(&self, module: ModuleId) -> Purity {
        if module.index() == 1 {
            Purity::State
        } else {
            Purity::Arguments
        }
    }

    fn evaluate(
        &self,
        module: ModuleId,
        calls: &[Arguments],
        state: Option<&dyn StateView>,
    ) -> Result<Vec<f64>, (usize, String)> {
        match module.index() {
            0 => Ok(calls
                .iter()
                .map(|call| if call[0] == "far" { f64::INFINITY } else { 4.0 })
                .collect()),
            1 => {
                let level = state
                    .and_then(|state| state.value(FunctionId(0), &[]))
                    .ok_or((0, "no level".to_owned()))?;
                Ok(vec![f64::from(u8::from(level >= 1.0)); calls.len()])
            }
            _ => Err((0, "not a number-valued module".into())),
        }
    }

    fn apply(
        &self,
        _: ModuleId,
        call: &Arguments,
        state: &dyn StateView,
    ) -> Result<Option<Vec<f64>>, String> {
        let level = state
            .value(FunctionId(0), &[] as &[ObjectId])
            .unwrap_or(0.0);
        match call[0].as_str() {
            "near" => Ok(Some(vec![level + 1.0])),
            "far" => Ok(None),
            _ => Err("unknown place".into()),
        }
    }
}

fn modules() -> Case {
    case(
        "(define (domain modules)
          (:requirements :typing :durative-actions :numeric-fluents)
          (:types place - object)
          (:modules (cost ?p - place cost cost@lib) (enough ?p - place conditionchecker enough@lib)
                    (fill ?p - place (level) effect fill@lib))
          (:predicates (visited ?p - place))
          (:functions (level))
          (:durative-action go :parameters (?p - place) :duration (= ?duration [cost ?p])
           :condition (and (at start ([enough ?p]))) :effect (at end (visited ?p)))
          (:action pour :parameters (?p - place) :precondition (and) :effect ([fill ?p])))",
        "(define (problem p) (:domain modules) (:objects near far other - place)
          (:init (= (level) 0)) (:goal (visited near)))",
    )
}

#[test]
fn attachments_give_durations_conditions_and_effects() {
    let case = modules();
    let verdict = |plan: &str| case.verdict_with(plan, &Options::default(), &Modules);
    let code = |plan: &str| verdict(plan).failure.map(|failure| failure.reason.code());
    assert_eq!(code("0: (pour near) 1: (go near)[4]"), None);
    assert_eq!(code("1: (go near)[4]"), Some("condition"));
    assert_eq!(code("0: (pour near) 1: (go near)[3]"), Some("duration"));
    assert_eq!(
        code("0: (pour near) 1: (go far)[4]"),
        Some("duration"),
        "infinite"
    );
    assert_eq!(
        code("0: (pour far) 1: (go near)[4]"),
        Some("effect-refused")
    );
    let failure = verdict("0: (pour other)").failure.unwrap();
    assert_eq!(failure.reason.code(), "attachment");
    assert!(
        failure
            .to_string()
            .contains("attachment [fill other] of action (pour other): unknown place"),
        "{failure}"
    );
}

#[test]
fn a_missing_attachment_is_said() {
    let (code, message) = modules().rejected("1: (go near)[4]");
    assert_eq!(code, "attachment");
    assert!(message.contains("no provider"), "{message}");
}

#[test]
fn the_empty_plan_is_valid_where_the_goal_holds_already() {
    let case = logic();
    let verdict = case.accepted("; nothing to do\n");
    assert_eq!(verdict.makespan, 0.0);
}
