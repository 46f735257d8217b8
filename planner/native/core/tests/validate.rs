//! The validator on plans that must pass and plans that must be rejected, one language feature each.

use planner_core::attachment::{Arguments, Attachments, NoAttachments, Purity, StateView};
use planner_core::pddl::model::{Domain, FunctionId, ModuleId, ObjectId, Problem};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::plan::reader;
use planner_core::syntax::diagnostic::has_errors;
use planner_core::syntax::render::render_all;
use planner_core::syntax::source::SourceFile;
use planner_core::validate::{Options, Verdict, validate};

struct Case {
    domain: Domain,
    problem: Problem,
}

fn case(domain: &str, problem: &str) -> Case {
    let domain_source = SourceFile::new("d.pddl", domain);
    let (domain, diagnostics) = read_domain(&domain_source);
    assert!(
        !has_errors(&diagnostics),
        "{}",
        render_all(&diagnostics, &domain_source, None)
    );
    let domain = domain.unwrap();
    let source = SourceFile::new("p.pddl", problem);
    let (problem, diagnostics) = read_problem(&source, &domain);
    assert!(
        !has_errors(&diagnostics),
        "{}",
        render_all(&diagnostics, &source, Some(&domain_source))
    );
    Case {
        domain,
        problem: problem.unwrap(),
    }
}

impl Case {
    fn verdict_with(
        &self,
        plan: &str,
        options: &Options,
        attachments: &dyn Attachments,
    ) -> Verdict {
        let source = SourceFile::new("plan", plan);
        let (plan, diagnostics) = reader::read(&source, &self.domain, &self.problem);
        let plan = plan.unwrap_or_else(|| panic!("{}", render_all(&diagnostics, &source, None)));
        validate(&self.domain, &self.problem, &plan, attachments, options)
    }

    fn verdict(&self, plan: &str) -> Verdict {
        self.verdict_with(plan, &Options::default(), &NoAttachments)
    }

    /// Why the plan is rejected: the code and the message.
    fn rejected(&self, plan: &str) -> (&'static str, String) {
        let failure = self
            .verdict(plan)
            .failure
            .expect("the plan must be rejected");
        (failure.reason.code(), failure.to_string())
    }

    fn accepted(&self, plan: &str) -> Verdict {
        let verdict = self.verdict(plan);
        assert_eq!(
            verdict.failure.as_ref().map(ToString::to_string),
            None,
            "the plan must be accepted"
        );
        verdict
    }
}

/// Mending fuses by the light of a match: required concurrency.
fn match_cellar() -> Case {
    case(
        "(define (domain match-cellar)
          (:requirements :typing :durative-actions :numeric-fluents)
          (:types match fuse - object)
          (:predicates (light ?m - match) (unused ?m - match) (mended ?f - fuse) (handfree))
          (:functions (burning) (mending ?f - fuse))
          (:durative-action light_match :parameters (?m - match)
           :duration (= ?duration (burning))
           :condition (and (at start (unused ?m)) (over all (light ?m)))
           :effect (and (at start (not (unused ?m))) (at start (light ?m)) (at end (not (light ?m)))))
          (:durative-action mend_fuse :parameters (?f - fuse ?m - match)
           :duration (= ?duration (mending ?f))
           :condition (and (at start (handfree)) (over all (light ?m)))
           :effect (and (at start (not (handfree))) (at end (mended ?f)) (at end (handfree)))))",
        "(define (problem one) (:domain match-cellar) (:objects m1 m2 - match f1 f2 - fuse)
          (:init (unused m1) (unused m2) (handfree) (= (burning) 8) (= (mending f1) 3) (= (mending f2) 4))
          (:goal (and (mended f1) (mended f2))) (:metric minimize (total-time)))",
    )
}

#[test]
fn a_fuse_is_mended_inside_the_match() {
    let verdict = match_cellar().accepted(
        "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]
         3.002: (mend_fuse f2 m1) [4.000]",
    );
    assert_eq!(verdict.makespan, 8.0);
    assert_eq!(verdict.metric, Some(8.0));
}

#[test]
fn an_invariant_may_begin_where_its_fact_does() {
    // The light is added at the start of the match; the over-all interval is open at its start.
    match_cellar().accepted(
        "0: (light_match m1)[8]
         0: (mend_fuse f1 m1)[3]
         3.001: (mend_fuse f2 m1)[4]",
    );
}

#[test]
fn the_match_goes_out_too_early() {
    let (code, message) = match_cellar().rejected(
        "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]
         5.000: (mend_fuse f2 m1) [4.000]",
    );
    assert_eq!(code, "condition");
    assert_eq!(
        message,
        "happening 5, time 8: (mend_fuse f2 m1) (step 3): its condition over all (light m1) does not hold
  (light m1) is false since 8 (end of (light_match m1))"
    );
}

#[test]
fn the_end_of_an_interval_is_open() {
    // The light goes out exactly when the fuse is done: the over-all condition held before.
    match_cellar().accepted(
        "0.000: (light_match m1) [8.000]
         1.000: (mend_fuse f1 m1) [3.000]
         4.000001: (light_match m2) [8.000]
         8.000001: (mend_fuse f2 m2) [4.000]",
    );
}

#[test]
fn two_actions_at_one_moment_may_not_need_and_delete_the_same() {
    let (code, message) = match_cellar().rejected(
        "0.000: (light_match m1) [8.000]
         0.000: (mend_fuse f1 m1) [3.000]
         3.000: (mend_fuse f2 m1) [4.000]",
    );
    assert_eq!(code, "condition", "{message}");
    assert!(message.contains("(handfree) is false since 0 (start of (mend_fuse f1 m1))"));
    let (code, message) = match_cellar().rejected(
        "0.000: (light_match m1) [8.000]
         0.000: (mend_fuse f1 m1) [3.000]
         0.000: (mend_fuse f2 m1) [4.000]",
    );
    assert_eq!(code, "interference", "{message}");
    assert!(message.contains("(handfree)"), "{message}");
}

#[test]
fn a_goal_that_does_not_hold_is_named_alone() {
    let (code, message) = match_cellar().rejected(
        "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]",
    );
    assert_eq!(code, "goal");
    assert!(
        message.contains("the goal (mended f2) does not hold"),
        "{message}"
    );
    assert!(!message.contains("(and "), "{message}");
}

#[test]
fn durations_hold_within_the_tolerance() {
    let case = match_cellar();
    let plan = |duration: f64| {
        format!(
            "0.000: (light_match m1) [8.000]
             0.001: (mend_fuse f1 m1) [{duration}]
             3.002: (mend_fuse f2 m1) [4.000]"
        )
    };
    assert!(case.verdict(&plan(3.0005)).valid());
    let (code, message) = case.rejected(&plan(3.5));
    assert_eq!(code, "duration");
    assert!(
        message.contains("its duration is 3.5 but must be = 3, the value of (mending f1)"),
        "{message}"
    );
    let strict = Options::strict(0.001);
    assert!(
        !case
            .verdict_with(&plan(3.0005), &strict, &NoAttachments)
            .valid()
    );
}

#[test]
fn separation_is_asked_only_where_wanted() {
    let case = match_cellar();
    let plan = "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]
         3.0012: (mend_fuse f2 m1) [4.000]";
    case.accepted(plan);
    let verdict = case.verdict_with(plan, &Options::strict(0.001), &NoAttachments);
    assert_eq!(verdict.failure.unwrap().reason.code(), "interference");
    let apart = "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]
         3.002: (mend_fuse f2 m1) [4.000]";
    let verdict = case.verdict_with(apart, &Options::strict(0.001), &NoAttachments);
    assert!(verdict.valid(), "{:?}", verdict.failure);
}

#[test]
fn a_report_tells_every_check_and_change() {
    let options = Options {
        report: true,
        ..Options::default()
    };
    let verdict = match_cellar().verdict_with(
        "0: (light_match m1)[8]
         0.001: (mend_fuse f1 m1)[3]
         3.002: (mend_fuse f2 m1)[4]",
        &options,
        &NoAttachments,
    );
    let report = verdict.report.join("\n");
    for line in [
        "happening 1, time 0",
        "  start of (light_match m1)",
        "    duration 8 = (burning) holds",
        "    (unused m1) holds",
        "  start of (light_match m1) adds (light m1)",
        "  over all of (mend_fuse f1 m1): (light m1) holds",
        "  end of (light_match m1) deletes (light m1)",
        "the goal holds",
    ] {
        assert!(report.lines().any(|one| one == line), "{line}\n{report}");
    }
}

/// Numbers: capacity, energy, ?duration in effects, duration inequalities.
fn numbers() -> Case {
    case(
        "(define (domain numbers)
          (:requirements :typing :durative-actions :numeric-fluents :duration-inequalities :negative-preconditions)
          (:types robot - object)
          (:predicates (charged ?r - robot) (busy ?r - robot) (done))
          (:functions (energy ?r - robot) (capacity) (load) (total-cost) (unset))
          (:durative-action charge :parameters (?r - robot)
           :duration (and (>= ?duration 1) (<= ?duration 10))
           :condition (and (at start (not (busy ?r))) (over all (<= (energy ?r) (capacity))))
           :effect (and (at start (busy ?r)) (at end (not (busy ?r)))
                        (at end (increase (energy ?r) (* 2 ?duration))) (at end (charged ?r))))
          (:action pick :parameters (?r - robot)
           :precondition (and (< (load) 2))
           :effect (and (increase (load) 1) (increase (total-cost) 3)))
          (:action count :parameters () :effect (increase (total-cost) 1))
          (:action reset :parameters () :effect (assign (total-cost) 0))
          (:action twice :parameters () :effect (and (assign (load) 0) (assign (load) 1)))
          (:action divide :parameters () :effect (scale-down (load) (- (capacity) (capacity))))
          (:action read :parameters () :precondition (>= (unset) 0) :effect (done)))",
        "(define (problem p) (:domain numbers) (:objects r1 r2 - robot)
          (:init (= (energy r1) 0) (= (energy r2) 3) (= (capacity) 20) (= (load) 0))
          (:goal (>= (energy r1) 6)) (:metric maximize (- (energy r1) (total-cost))))",
    )
}

#[test]
fn duration_enters_effects_and_the_metric_is_evaluated_at_the_end() {
    let verdict = numbers().accepted("0: (charge r1)[4] 1: (pick r1) 2: (pick r2)");
    assert_eq!(verdict.metric, Some(8.0 - 6.0));
}

#[test]
fn duration_inequalities_bound_both_sides() {
    let (code, message) = numbers().rejected("0: (charge r1)[0.5]");
    assert_eq!(code, "duration");
    assert!(message.contains("0.5 but must be >= 1"), "{message}");
    assert_eq!(numbers().rejected("0: (charge r1)[11]").0, "duration");
}

#[test]
fn a_numeric_condition_shows_the_values() {
    let (code, message) =
        numbers().rejected("0: (charge r1)[4] 5: (pick r1) 6: (pick r1) 7: (pick r1)");
    assert_eq!(code, "condition");
    assert!(
        message.contains("its condition (< (load) 2) does not hold"),
        "{message}"
    );
    assert!(
        message.contains("(load) is 2 since 6 ((pick r1))"),
        "{message}"
    );
}

#[test]
fn increases_commute_but_assignments_and_readers_do_not() {
    numbers().accepted("0: (charge r1)[4] 1: (count) 1: (pick r1)");
    assert_eq!(
        numbers()
            .rejected("0: (charge r1)[4] 1: (count) 1: (reset)")
            .0,
        "interference"
    );
    // Both read the load and increase it.
    assert_eq!(
        numbers()
            .rejected("0: (charge r1)[4] 1: (pick r1) 1: (pick r2)")
            .0,
        "interference"
    );
}

#[test]
fn numeric_faults_have_names() {
    assert_eq!(
        numbers().rejected("0: (charge r1)[4] 1: (twice)").0,
        "double-assignment"
    );
    assert_eq!(
        numbers().rejected("0: (charge r1)[4] 1: (divide)").0,
        "not-a-number"
    );
    let (code, message) = numbers().rejected("0: (charge r1)[4] 1: (read)");
    assert_eq!(code, "undefined");
    assert!(message.contains("(unset) has no value"), "{message}");
}

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
