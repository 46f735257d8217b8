//! Every part of the language that is supported, read into the typed model.

use planner_core::pddl::model::{
    Arithmetic, Comparison, ConditionKind, Domain, EffectKind, ExpressionKind, ModuleKind, Problem,
    Term, TimedChange, VariableId, When,
};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::syntax::render::render_all;
use planner_core::syntax::source::SourceFile;

fn domain(text: &str) -> Domain {
    let source = SourceFile::new("d.pddl", text);
    let (domain, diagnostics) = read_domain(&source);
    assert!(
        diagnostics.is_empty(),
        "{}",
        render_all(&diagnostics, &source, None)
    );
    domain.unwrap()
}

fn problem(text: &str, domain: &Domain) -> Problem {
    let source = SourceFile::new("p.pddl", text);
    let (problem, diagnostics) = read_problem(&source, domain);
    assert!(
        diagnostics.is_empty(),
        "{}",
        render_all(&diagnostics, &source, None)
    );
    problem.unwrap()
}

const FULL: &str = include_str!("files/everything.pddl");

#[test]
fn a_domain_with_everything_in_it() {
    let domain = domain(FULL);
    assert_eq!(domain.name.text, "full");
    let types: Vec<&str> = domain.types.iter().map(|t| t.name.text.as_str()).collect();
    assert_eq!(types, ["object", "robot", "place", "dock", "small", "big"]);
    assert_eq!(
        domain.types[4].parents,
        [planner_core::pddl::model::TypeId(1)]
    );
    assert_eq!(domain.constants[0].name.text, "base");
    assert!(domain.predicates[2].derived && !domain.predicates[0].derived);
    assert_eq!(domain.action_initialiser.unwrap().text, "start@libGrid.so");

    let kinds: Vec<ModuleKind> = domain.modules.iter().map(|module| module.kind).collect();
    assert_eq!(
        kinds,
        [ModuleKind::Cost, ModuleKind::Condition, ModuleKind::Effect]
    );
    assert_eq!(domain.modules[0].name.text, "pathcost");
    assert_eq!(domain.modules[0].call.text, "pathCost@libGrid.so");
    assert_eq!(domain.modules[2].writes.len(), 2);

    let rule = &domain.derived[0];
    let ConditionKind::Forall(variables, body) = &rule.condition.kind else {
        panic!("a forall")
    };
    assert_eq!(variables[0].name.text, "?p");
    let ConditionKind::Not(inner) = &body.kind else {
        panic!("a negation")
    };
    let ConditionKind::Atom(atom) = &inner.kind else {
        panic!("an atom")
    };
    let expected = [Term::Variable(VariableId(0)), Term::Variable(VariableId(1))];
    assert_eq!(atom.arguments, expected);
}

#[test]
fn a_durative_action() {
    let domain = domain(FULL);
    let action = &domain.actions[0];
    assert_eq!(action.name.text, "move");
    assert_eq!(action.parameters[1].types.len(), 2);

    let duration = action.duration.as_ref().unwrap();
    let constraints: Vec<(Comparison, When)> = duration
        .iter()
        .map(|bound| (bound.comparison, bound.when))
        .collect();
    assert_eq!(
        constraints,
        [
            (Comparison::GreaterEqual, When::Start),
            (Comparison::LessEqual, When::Start),
            (Comparison::LessEqual, When::End)
        ]
    );
    assert!(matches!(duration[0].bound.kind, ExpressionKind::Module(_)));
    let ExpressionKind::Binary(Arithmetic::Add, left, right) = &duration[2].bound.kind else {
        panic!("a sum folded to the left")
    };
    assert!(matches!(
        left.kind,
        ExpressionKind::Binary(Arithmetic::Add, _, _)
    ));
    assert!(matches!(right.kind, ExpressionKind::Negate(_)));

    let times: Vec<When> = action.conditions.iter().map(|&(when, _)| when).collect();
    use When::{End, OverAll, Start};
    assert_eq!(times, [Start, OverAll, End, Start, OverAll]);
    assert!(matches!(
        action.conditions[1].1.kind,
        ConditionKind::Module(_)
    ));
    assert!(matches!(
        action.conditions[3].1.kind,
        ConditionKind::Forall(_, _)
    ));

    let times: Vec<When> = action.effects.iter().map(|&(when, _)| when).collect();
    assert_eq!(times, [Start, End, End, End, End]);
    let EffectKind::Forall(_, body) = &action.effects[3].1.kind else {
        panic!("a forall")
    };
    let EffectKind::TimedWhen(conditions, effect) = &body.kind else {
        panic!("a timed when")
    };
    assert_eq!(conditions[0].0, OverAll);
    let EffectKind::Add(atom) = &effect.kind else {
        panic!("an added atom")
    };
    // Parameters are 0 to 2, the quantified variable is 3.
    assert_eq!(atom.arguments[0], Term::Variable(VariableId(3)));
    assert!(matches!(action.effects[4].1.kind, EffectKind::Module(_)));
}

#[test]
fn a_when_whose_times_agree_is_an_ordinary_one() {
    let domain = domain(
        "(define (domain d) (:requirements :durative-actions :conditional-effects)
         (:predicates (p) (q))
         (:durative-action a :parameters () :duration (= ?duration 1) :condition ()
          :effect (when (and (at end (p))) (and (at end (q))))))",
    );
    assert!(matches!(
        domain.actions[0].effects[0].1.kind,
        EffectKind::When(_, _)
    ));
}

#[test]
fn a_problem_with_everything_in_it() {
    let domain = domain(
        "(define (domain d)
          (:requirements :typing :numeric-fluents :timed-initial-literals :equality :existential-preconditions)
          (:types robot place) (:constants home - place)
          (:predicates (at ?r - robot ?p - place) (open ?p - place))
          (:functions (fuel ?r - robot) (total-cost)))",
    );
    let problem = problem(
        "(define (problem Pr) (:metric maximize (- (total-cost) (* 3 total-time)))
          (:goal (exists (?r - robot) (and (at ?r home) (not (= ?r r1)))))
          (:init (AT R1 home) (= (fuel r1) 3.5) (at 5 (open home)) (at 7.5 (not (open home)))
                 (at 9 (= (fuel r1) 1)) (= total-cost 0) (not (open home)) (at 0 (at r2 home)))
          (:moduleoptions (init@libGrid.so Some/File.pgm 5)) (:moduleexitoptions (exit@libGrid.so))
          (:objects r1 r2 - robot) (:requirements :negative-preconditions) (:domain d))",
        &domain,
    );
    let objects: Vec<&str> = problem
        .objects
        .iter()
        .map(|o| o.name.text.as_str())
        .collect();
    assert_eq!(objects, ["home", "r1", "r2"]);
    assert_eq!(problem.facts.len(), 2);
    assert_eq!(problem.fluents.len(), 2);
    assert!((problem.fluents[0].1 - 3.5).abs() < 1e-12);
    let times: Vec<f64> = problem.timed.iter().map(|timed| timed.time).collect();
    assert_eq!(times, [5.0, 7.5, 9.0]);
    assert!(matches!(problem.timed[1].change, TimedChange::Delete(_)));
    assert!(matches!(problem.timed[2].change, TimedChange::Assign(_, _)));
    assert!(matches!(problem.goal.kind, ConditionKind::Exists(_, _)));
    let metric = problem.metric.unwrap();
    assert!(metric.maximise);
    assert!(matches!(
        metric.expression.kind,
        ExpressionKind::Binary(Arithmetic::Subtract, _, _)
    ));
    assert_eq!(problem.module_options[0].1[0].text, "Some/File.pgm");
    assert_eq!(problem.module_exit_options.len(), 1);
}

#[test]
fn a_user_predicate_may_be_called_at() {
    let domain = domain(
        "(define (domain d) (:requirements :timed-initial-literals)
         (:predicates (at ?x ?y) (p))
         (:durative-action a :parameters (?x ?y) :duration (= ?duration 1)
          :condition (at start (at ?x ?y)) :effect (at end (p))))",
    );
    assert!(matches!(
        domain.actions[0].conditions[0].1.kind,
        ConditionKind::Atom(_)
    ));
    let problem = problem(
        "(define (problem p) (:domain d) (:objects start end 5)
         (:init (at start end) (at 5 end) (at 5 (p))) (:goal (at start end)))",
        &domain.clone(),
    );
    assert_eq!((problem.facts.len(), problem.timed.len()), (2, 1));
}

#[test]
fn long_sums_stay_shallow() {
    let sum = format!("(+ {})", "1 ".repeat(50_000));
    let domain = domain("(define (domain d) (:predicates (p)))");
    let text =
        format!("(define (problem p) (:domain d) (:init) (:goal (p)) (:metric minimize {sum}))");
    let problem = problem(&text, &domain);
    fn depth_and_leaves(kind: &ExpressionKind) -> (usize, usize) {
        match kind {
            ExpressionKind::Binary(_, left, right) => {
                let (a, b) = (depth_and_leaves(&left.kind), depth_and_leaves(&right.kind));
                (1 + a.0.max(b.0), a.1 + b.1)
            }
            _ => (1, 1),
        }
    }
    let (depth, leaves) = depth_and_leaves(&problem.metric.unwrap().expression.kind);
    assert_eq!(leaves, 50_000);
    assert!(depth < 64, "{depth}");
}

#[test]
fn a_goal_of_preferences_is_refused_by_name_and_place() {
    let domain = domain("(define (domain d) (:requirements :strips) (:predicates (p)))");
    let text = "(define (problem p) (:domain d) (:init) (:goal (and (preference one (p)))))";
    let source = SourceFile::new("p.pddl", text);
    let (_, diagnostics) = read_problem(&source, &domain);
    let found = &diagnostics[0];
    assert_eq!(
        found.severity,
        planner_core::syntax::diagnostic::Severity::Error
    );
    assert_eq!(found.message, "preferences are not supported");
    assert_eq!(source.slice(found.span), "preference");
}
