//! Grounding a part of a problem whose movements are too many.

mod support;

use std::fmt::Write as _;

use planner_core::attachment::{Arguments, Attachments, Purity, StateView};
use planner_core::grounding::{GroundingError, GroundingLimits, ground, ground_partially};
use planner_core::outcome::Outcome;
use planner_core::pddl::model::{Domain, ModuleId, Problem};
use planner_core::solve::{SolveOptions, solve, solve_task};
use std::time::Instant;
use support::{check, options, read};

const TEAM: &str = "(define (domain team)
 (:requirements :typing :durative-actions :equality)
 (:types robot place - object target gate - place)
 (:modules (way ?r - robot ?x ?y - place cost way@map))
 (:predicates (at ?r - robot ?x - place) (open ?x - gate) (seen ?t - target))
 (:durative-action go :parameters (?r - robot ?x ?y - place) :duration (= ?duration [way ?r ?x ?y])
  :condition (and (at start (at ?r ?x)) (at start (not (= ?x ?y))))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y))))
 (:durative-action clear :parameters (?r - robot ?g - gate) :duration (= ?duration 5)
  :condition (over all (at ?r ?g)) :effect (at end (open ?g)))
 (:durative-action look :parameters (?r - robot ?t - target) :duration (= ?duration 1)
  :condition (over all (at ?r ?t)) :effect (at end (seen ?t))))";

/// Places on a line, one a metre; the last target is to be reached from the gate only.
struct Line {
    last: String,
}

impl Attachments for Line {
    fn purity(&self, _: ModuleId) -> Purity {
        Purity::Arguments
    }

    fn evaluate(
        &self,
        _: ModuleId,
        calls: &[Arguments],
        _: Option<&dyn StateView>,
    ) -> Result<Vec<f64>, (usize, String)> {
        let place = |name: &str| name[1..].parse::<f64>().unwrap_or(0.0);
        let way = |call: &Arguments| {
            if call[2] == self.last && !call[1].starts_with('g') {
                return f64::INFINITY;
            }
            (place(&call[1]) - place(&call[2])).abs() + 0.5
        };
        Ok(calls.iter().map(way).collect())
    }

    fn apply(
        &self,
        _: ModuleId,
        _: &Arguments,
        _: &dyn StateView,
    ) -> Result<Option<Vec<f64>>, String> {
        Err("no effects here".into())
    }
}

fn team(robots: usize, targets: usize) -> (Domain, Problem, Line) {
    let (mut objects, mut init, mut goal) = (String::new(), String::new(), String::new());
    for robot in 0..robots {
        let _ = write!(objects, "r{robot} - robot ");
        let _ = write!(init, "(at r{robot} t{}) ", robot * targets / robots);
    }
    for target in 0..targets {
        let _ = write!(objects, "t{target} - target ");
        let _ = write!(goal, "(seen t{target}) ");
    }
    let text = format!(
        "(define (problem p) (:domain team) (:objects {objects} g{} - gate)
         (:init {init}) (:goal (and {goal})))",
        targets / 2
    );
    let (domain, problem) = read(TEAM, &text);
    let last = format!("t{}", targets - 1);
    (domain, problem, Line { last })
}

#[test]
fn a_part_is_much_smaller_and_still_has_a_plan() {
    let (domain, problem, line) = team(6, 24);
    let limits = GroundingLimits::default();
    let whole = ground(&domain, &problem, &line, &limits).expect("grounds");
    let part = ground_partially(&domain, &problem, &line, &limits, 2).expect("grounds");
    assert!(part.partial && !whole.partial);
    assert!(!part.unsolvable);
    assert!(
        3 * part.operators.len() < whole.operators.len(),
        "{} of {}",
        part.operators.len(),
        whole.operators.len()
    );
    let report = solve_task(&part, &line, &options(), Instant::now(), &mut |_| {});
    let report = report.expect("no attachment fails");
    let best = report.plans.last().expect("a plan");
    check(&domain, &problem, &line, &best.plan);
    assert!(best.plan.steps.iter().any(|step| step.action == "go"
        && step.arguments[1].starts_with('g')
        && step.arguments[2] == line.last));
    assert_eq!(report.lower_bound, 0.0, "a part proves nothing");
    assert_ne!(report.outcome, Outcome::SolvedOptimally);
}

#[test]
fn a_wide_part_is_the_whole() {
    let (domain, problem, line) = team(2, 5);
    let limits = GroundingLimits::default();
    let names = |task: planner_core::task::Task| {
        let ids = (0..task.operators.len() as u32).map(planner_core::task::OperatorId);
        let mut names: Vec<String> = ids.map(|id| task.operator_name(id)).collect();
        names.sort();
        names
    };
    let whole = ground(&domain, &problem, &line, &limits).expect("grounds");
    let part = ground_partially(&domain, &problem, &line, &limits, 1_000).expect("grounds");
    assert_eq!(names(whole), names(part));
}

#[test]
fn too_many_candidates_are_noticed() {
    let (domain, problem, line) = team(6, 24);
    let limits = GroundingLimits {
        candidates: 500,
        ..GroundingLimits::default()
    };
    let error = ground(&domain, &problem, &line, &limits).map(|task| task.operators.len());
    assert_eq!(error, Err(GroundingError::TooManyCandidates));
}

#[test]
fn a_plan_of_a_narrow_part_is_improved_in_a_wider_one() {
    let (domain, problem, line) = team(6, 24);
    let options = SolveOptions {
        whole_below: 200,
        node_limit: Some(4_000),
        ..options()
    };
    let mut reported = Vec::new();
    let report = solve(&domain, &problem, &line, &options, &mut |plan| {
        reported.push(plan.makespan());
    })
    .expect("solves");
    let kept: Vec<f64> = report
        .plans
        .iter()
        .map(|found| found.plan.makespan())
        .collect();
    assert_eq!(reported.len(), kept.len());
    assert!(kept.len() > 1, "{kept:?}");
    assert!(
        report
            .plans
            .windows(2)
            .all(|pair| pair[1].cost < pair[0].cost)
    );
    for found in &report.plans {
        check(&domain, &problem, &line, &found.plan);
    }
    let first = SolveOptions {
        first_plan_only: true,
        ..options
    };
    let report = solve(&domain, &problem, &line, &first, &mut |_| ()).expect("solves");
    assert_eq!(report.plans.len(), 1);
}
