//! How a search that is stopped tells its end, and what a warm start puts in force.

use std::fmt::Write as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use planner_core::attachment::NoAttachments;
use planner_core::outcome::{Limit, Outcome};
use planner_core::pddl::model::{Domain, Problem};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::plan::Plan;
use planner_core::solve::{SolveOptions, SolveReport, Stopped, solve};
use planner_core::syntax::source::SourceFile;

const VISITS: &str = "(define (domain visits) (:requirements :typing :durative-actions)
  (:types robot place)
  (:predicates (at ?r - robot ?p - place) (seen ?p - place))
  (:durative-action go :parameters (?r - robot ?a ?b - place)
    :duration (= ?duration 0.1) :condition (at start (at ?r ?a))
    :effect (and (at start (not (at ?r ?a))) (at end (at ?r ?b)) (at end (seen ?b)))))";

/// Two robots at the first of so many places, all of which are to be seen.
fn visits(places: usize) -> (Domain, Problem) {
    let domain = read_domain(&SourceFile::new("domain", VISITS)).0;
    let (mut names, mut goal) = (String::new(), String::new());
    for place in 0..places {
        let _ = write!(names, " p{place}");
        if place > 0 {
            let _ = write!(goal, " (seen p{place})");
        }
    }
    let text = format!(
        "(define (problem visit) (:domain visits) (:objects r1 r2 - robot{names} - place)
         (:init (at r1 p0) (at r2 p0)) (:goal (and{goal})))"
    );
    let domain = domain.expect("a domain");
    let problem = read_problem(&SourceFile::new("problem", text), &domain).0;
    (domain, problem.expect("a problem"))
}

/// Runs until a first plan was found, then asks to stop; what was told when, and what was returned.
fn stopped_after_a_plan(options: &SolveOptions<'_>) -> (Vec<SolveReport>, SolveReport) {
    let (domain, problem) = visits(9);
    let cancel = AtomicBool::new(false);
    let told = Mutex::new(Vec::new());
    let listener = |report: &SolveReport| told.lock().expect("a lock").push(report.clone());
    let options = SolveOptions {
        cancel: Some(&cancel),
        stopped: Some(Stopped(&listener)),
        ..*options
    };
    let report = solve(&domain, &problem, &NoAttachments, &options, &mut |_| {
        cancel.store(true, Ordering::Relaxed);
    });
    (told.into_inner().expect("told"), report.expect("a report"))
}

#[test]
fn a_stopped_search_tells_once_what_it_returns_later() {
    for threads in [1, 2] {
        let options = SolveOptions {
            threads,
            ..SolveOptions::default()
        };
        let (told, report) = stopped_after_a_plan(&options);
        assert_eq!(told.len(), 1, "{threads} threads");
        assert_eq!(report.limit, Some(Limit::Cancelled));
        assert_eq!(told[0].outcome, Outcome::Solved);
        assert_eq!(
            (told[0].limit, &told[0].plans),
            (report.limit, &report.plans)
        );
    }
}

#[test]
fn a_search_that_is_done_tells_nothing_beforehand() {
    let (domain, problem) = visits(3);
    let listener = |report: &SolveReport| panic!("told of {report:?}");
    let options = SolveOptions {
        stopped: Some(Stopped(&listener)),
        ..SolveOptions::default()
    };
    let report = solve(&domain, &problem, &NoAttachments, &options, &mut |_| {});
    assert_eq!(report.expect("a report").outcome, Outcome::SolvedOptimally);
}

#[test]
fn what_is_left_of_a_plan_is_the_first_in_force_and_is_improved() {
    let (domain, problem) = visits(7);
    // One robot sees everything but the last place.
    let mut rest = Plan::default();
    let mut text = String::new();
    for place in 1..6 {
        let start = 0.101 * f64::from(place - 1);
        let _ = writeln!(text, "{start}: (go r1 p{} p{place}) [0.1]", place - 1);
    }
    let source = SourceFile::new("plan", text);
    if let (Some(plan), _) = planner_core::plan::reader::read(&source, &domain, &problem) {
        rest = plan;
    }
    assert_eq!(rest.steps.len(), 5);
    for threads in [1, 2] {
        let options = SolveOptions {
            threads,
            warm_start: Some(&rest),
            ..SolveOptions::default()
        };
        let mut plans: Vec<Plan> = Vec::new();
        let report = solve(&domain, &problem, &NoAttachments, &options, &mut |plan| {
            plans.push(plan.clone());
        })
        .expect("a report");
        for step in &rest.steps {
            let kept = |other: &&planner_core::plan::Step| other.arguments == step.arguments;
            assert!(plans[0].steps.iter().any(|other| kept(&other)), "{step}");
        }
        let best = report.plans.last().expect("a plan").plan.makespan();
        assert!(best < 0.31, "{best} s with {threads} threads");
        assert_eq!(report.plans.len(), plans.len());
    }
}

#[test]
fn times_have_no_dust() {
    let (domain, problem) = visits(12);
    let options = SolveOptions {
        node_limit: Some(50),
        ..SolveOptions::default()
    };
    let mut steps = 0;
    let report = solve(&domain, &problem, &NoAttachments, &options, &mut |plan| {
        for step in &plan.steps {
            let milliseconds = step.start * 1000.0;
            assert_eq!(milliseconds.round() / 1000.0, step.start);
            steps += 1;
        }
    });
    assert!(report.is_ok() && steps > 0);
}

#[test]
fn grounding_that_is_stopped_tells_it_before_it_returns() {
    let (domain, problem) = visits(9);
    let cancel = AtomicBool::new(true);
    let told = Mutex::new(Vec::new());
    let listener = |report: &SolveReport| told.lock().expect("a lock").push(report.clone());
    let options = SolveOptions {
        cancel: Some(&cancel),
        stopped: Some(Stopped(&listener)),
        ..SolveOptions::default()
    };
    let report = solve(&domain, &problem, &NoAttachments, &options, &mut |_| {}).expect("a report");
    let told = told.into_inner().expect("told");
    assert_eq!(told.len(), 1);
    assert_eq!(told[0].outcome, Outcome::Cancelled);
    assert_eq!(
        (told[0].limit, report.limit),
        (Some(Limit::Cancelled), Some(Limit::Cancelled))
    );
}
