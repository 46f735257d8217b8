//! Laws that all heuristics keep, and searches under each of them.

#[path = "support/tasks.rs"]
mod tasks;

use planner_core::attachment::NoAttachments;
use planner_core::epoch::calls::Calls;
use planner_core::epoch::compiled::Compiled;
use planner_core::epoch::transitions::Transitions;
use planner_core::heuristic::choice::Choice;
use planner_core::heuristic::relaxed::RelaxedTask;
use planner_core::heuristic::temporal_ff::TemporalFf;
use planner_core::heuristic::{Estimate, Heuristic};
use planner_core::outcome::Outcome;
use planner_core::pddl::{read_domain, read_problem};
use planner_core::solve::{SolveOptions, Space, solve};
use planner_core::syntax::source::SourceFile;
use planner_core::task::OperatorId;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use tasks::random_task;

/// Zero at goals; a dead end only where the delete relaxation says so. Random walks.
#[test]
fn all_heuristics_keep_their_laws_along_random_walks() {
    let (mut goals, mut dead, mut open) = (0, 0, 0);
    for seed in 0..150 {
        let task = random_task(seed, 5);
        if task.unsolvable || task.operators.is_empty() {
            continue;
        }
        let compiled = Compiled::new(&task);
        let relaxed = RelaxedTask::new(&task);
        let calls = Calls::new(&task, &NoAttachments);
        let transitions = Transitions {
            compiled: &compiled,
            calls: &calls,
        };
        let random = &mut ChaCha8Rng::seed_from_u64(seed);
        let mut state = transitions.initial();
        for _ in 0..20 {
            let hopeless = {
                let mut ff = TemporalFf::new(&compiled, &relaxed);
                ff.evaluate(&state) == Estimate::DeadEnd
            };
            for (name, choice) in Choice::NAMES {
                let graphs = choice.graphs(&|| false, &task, &relaxed);
                for mut heuristic in choice.heuristics(&compiled, &relaxed, graphs.as_ref()) {
                    let estimate = heuristic.evaluate(&state);
                    if transitions.is_goal(&state) {
                        assert_eq!(estimate, Estimate::Value(0), "{name}, seed {seed}");
                        goals += 1;
                    }
                    if hopeless && name != "blind" {
                        assert_eq!(estimate, Estimate::DeadEnd, "{name}, seed {seed}");
                        dead += 1;
                    }
                    if !hopeless {
                        assert_ne!(estimate, Estimate::DeadEnd, "{name}, seed {seed}");
                        open += 1;
                    }
                    for &operator in heuristic.preferred() {
                        let condition = &compiled.operator(operator).start_condition;
                        assert!(transitions.holds(condition, &state, 1.0, Some(operator)));
                    }
                }
            }
            let before = state.clone();
            let operator = OperatorId(random.random_range(0..task.operators.len() as u32));
            let goes_on = if random.random_range(0..4) == 0 {
                transitions.advance(&mut state)
            } else {
                transitions.start(&mut state, operator, false)
            };
            if !goes_on {
                state = before;
            }
        }
    }
    assert!(
        goals > 50 && dead > 50 && open > 1_000,
        "{goals} {dead} {open}"
    );
}

const TOUR: &str = "(define (domain tour) (:requirements :typing :durative-actions)
 (:types robot place)
 (:predicates (at ?r - robot ?p - place) (seen ?p - place) (way ?a ?b - place))
 (:durative-action drive :parameters (?r - robot ?a ?b - place) :duration (= ?duration 8)
  :condition (and (at start (at ?r ?a)) (at start (way ?a ?b)))
  :effect (and (at start (not (at ?r ?a))) (at end (at ?r ?b))))
 (:durative-action look :parameters (?r - robot ?p - place) :duration (= ?duration 4)
  :condition (over all (at ?r ?p)) :effect (at end (seen ?p))))";

/// Every heuristic finds plans, and the same ones when it is run again.
#[test]
fn decision_epochs_are_searched_under_every_heuristic() {
    for (name, choice) in Choice::NAMES {
        let run = || {
            let mut plans = Vec::new();
            let (domain, _) = read_domain(&SourceFile::new("domain", TOUR));
            let domain = domain.unwrap();
            let text = "(define (problem p) (:domain tour) (:objects r - robot a b c - place)
             (:init (at r a) (way a b) (way b c) (way c b) (way b a))
             (:goal (and (seen c) (at r a))))";
            let (problem, _) = read_problem(&SourceFile::new("problem", text), &domain);
            let options = SolveOptions {
                heuristic: Some(choice),
                space: Space::DecisionEpochs,
                node_limit: Some(3_000),
                timeout: None,
                ..SolveOptions::default()
            };
            let report = solve(
                &domain,
                &problem.unwrap(),
                &NoAttachments,
                &options,
                &mut |p| {
                    plans.push(p.clone());
                },
            );
            let report = report.unwrap();
            assert_eq!(report.schedules, 0, "{name}");
            (plans, report.outcome)
        };
        let (plans, outcome) = run();
        let best = plans
            .last()
            .unwrap_or_else(|| panic!("{name}: {outcome:?}"));
        // Four drives and a look.
        assert!(best.makespan() < 36.1, "{name}: {}", best.makespan());
        assert_ne!(outcome, Outcome::ProvenUnsolvable);
        assert_eq!(run(), (plans, outcome), "{name}");
    }
}

/// The limit holds in each space.
#[test]
fn no_more_nodes_are_taken_than_allowed() {
    let mut domain = String::from(TOUR);
    domain = domain.replace("look", "survey");
    let (domain, _) = read_domain(&SourceFile::new("domain", domain));
    let domain = domain.unwrap();
    let places: String = (0..9).map(|place| format!(" p{place}")).collect();
    let mut ways = String::new();
    for from in 0..9 {
        for to in 0..9 {
            ways += &format!(" (way p{from} p{to})");
        }
    }
    let goals: String = (0..9).map(|place| format!(" (seen p{place})")).collect();
    let text = format!(
        "(define (problem p) (:domain tour) (:objects r s - robot{places} - place)
         (:init (at r p0) (at s p0){ways}) (:goal (and{goals})))"
    );
    let (problem, _) = read_problem(&SourceFile::new("problem", text), &domain);
    let problem = problem.unwrap();
    for space in [Space::Portfolio, Space::DecisionEpochs] {
        for limit in [100, 700, 3_000] {
            let options = SolveOptions {
                space,
                node_limit: Some(limit),
                timeout: None,
                ..SolveOptions::default()
            };
            let report = solve(&domain, &problem, &NoAttachments, &options, &mut |_| {}).unwrap();
            let nodes = report.schedules + report.expansions;
            assert!(
                nodes <= limit + limit / 20 + 1,
                "{space:?} {limit}: {nodes}"
            );
            assert!(nodes > limit / 2, "{space:?} {limit}: {nodes}");
        }
    }
}
