//! The search against the validator, and against enumeration of all short plans, on random tasks.

use std::fmt::Write as _;
use std::time::Duration;

use planner_core::attachment::NoAttachments;
use planner_core::outcome::Outcome;
use planner_core::pddl::model::{Domain, Problem};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::plan::{EPSILON, Plan, Step};
use planner_core::solve::{SolveOptions, SolveReport, solve};
use planner_core::syntax::source::SourceFile;
use planner_core::validate::{Options, Validator};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

const FACTS: usize = 5;

struct Texts {
    domain: String,
    problem: String,
    actions: Vec<(String, Option<f64>)>,
}

/// What random tasks may contain.
#[derive(Clone, Copy)]
struct Mix {
    numbers: bool,
    timed: bool,
    conditional: bool,
    actions: usize,
}

fn literal(random: &mut ChaCha8Rng) -> String {
    let fact = format!("(p{})", random.random_range(0..FACTS));
    if random.random_range(0..4) == 0 {
        format!("(not {fact})")
    } else {
        fact
    }
}

fn condition(random: &mut ChaCha8Rng, mix: Mix) -> String {
    match random.random_range(0..10) {
        0 => format!("(or {} {})", literal(random), literal(random)),
        1 if mix.numbers => {
            let comparison = ["<", "<=", ">=", ">", "="][random.random_range(0..5)];
            format!("({comparison} (n) {})", random.random_range(0..3))
        }
        _ => literal(random),
    }
}

fn effect(random: &mut ChaCha8Rng, mix: Mix) -> String {
    if mix.numbers && random.random_range(0..5) == 0 {
        let change = ["increase", "decrease", "assign"][random.random_range(0..3)];
        return format!("({change} (n) {})", random.random_range(0..3));
    }
    literal(random)
}

fn random_task(seed: u64, mix: Mix) -> Texts {
    let random = &mut ChaCha8Rng::seed_from_u64(seed);
    let mut domain = String::from(
        "(define (domain random) (:requirements :adl :durative-actions :numeric-fluents :timed-initial-literals)\n (:predicates",
    );
    for fact in 0..FACTS {
        write!(domain, " (p{fact})").unwrap();
    }
    domain += ")\n (:functions (n))\n";
    let mut actions = Vec::new();
    for index in 0..mix.actions {
        let name = format!("a{index}");
        if random.random_range(0..5) == 0 {
            let (before, after) = (condition(random, mix), effect(random, mix));
            writeln!(
                domain,
                " (:action {name} :parameters () :precondition {before} :effect {after})"
            )
            .unwrap();
            actions.push((name, None));
            continue;
        }
        let duration = f64::from(random.random_range(1..4));
        let mut conditions = String::new();
        for when in ["at start", "over all", "at end"] {
            let often = if when == "at start" { 2 } else { 4 };
            if random.random_range(0..often) == 0 {
                write!(conditions, " ({when} {})", condition(random, mix)).unwrap();
            }
        }
        let mut effects = String::new();
        for when in ["at start", "at end"] {
            for _ in 0..2 {
                if random.random_range(0..2) == 0 {
                    let mut change = effect(random, mix);
                    if mix.conditional && random.random_range(0..4) == 0 {
                        let (inner, change_of) = (literal(random), change);
                        change = format!("(when ({when} {inner}) ({when} {change_of}))");
                        write!(effects, " {change}").unwrap();
                    } else {
                        write!(effects, " ({when} {change})").unwrap();
                    }
                }
            }
        }
        writeln!(
            domain,
            " (:durative-action {name} :parameters () :duration (= ?duration {duration})\n  :condition (and{conditions})\n  :effect (and{effects}))"
        )
        .unwrap();
        actions.push((name, Some(duration)));
    }
    domain += ")";
    let mut problem = String::from("(define (problem p) (:domain random)\n (:init (= (n) 1)");
    for fact in 0..FACTS {
        if random.random_range(0..3) == 0 {
            write!(problem, " (p{fact})").unwrap();
        }
    }
    if mix.timed {
        for index in 0..random.random_range(0..3) {
            let time = 1 + 2 * index;
            write!(problem, " (at {time} {})", literal(random)).unwrap();
        }
    }
    let goals: Vec<String> = (0..2).map(|_| literal(random)).collect();
    write!(
        problem,
        ")\n (:goal (and {}))\n (:metric minimize (total-time)))",
        goals.join(" ")
    )
    .unwrap();
    Texts {
        domain,
        problem,
        actions,
    }
}

fn read(texts: &Texts) -> (Domain, Problem) {
    let (domain, diagnostics) = read_domain(&SourceFile::new("d", texts.domain.as_str()));
    let domain = domain.unwrap_or_else(|| panic!("{diagnostics:?}\n{}", texts.domain));
    let (problem, diagnostics) =
        read_problem(&SourceFile::new("p", texts.problem.as_str()), &domain);
    let problem = problem.unwrap_or_else(|| panic!("{diagnostics:?}\n{}", texts.problem));
    (domain, problem)
}

/// Solves and checks that every plan reported is valid and that plans improve.
fn checked(texts: &Texts, domain: &Domain, problem: &Problem) -> SolveReport {
    let options = SolveOptions {
        timeout: Some(Duration::from_secs(20)),
        node_limit: Some(1_500),
        ..SolveOptions::default()
    };
    let report = solve(domain, problem, &NoAttachments, &options, &mut |_| {})
        .unwrap_or_else(|error| panic!("{error}\n{}\n{}", texts.domain, texts.problem));
    let validator = Validator::new(domain, problem, &NoAttachments);
    let mut best = f64::INFINITY;
    for found in &report.plans {
        let verdict = validator.validate(&found.plan, &Options::strict(EPSILON * 0.999));
        assert!(
            verdict.valid(),
            "{:?}\n{:?}\n{}\n{}",
            verdict.failure,
            found.plan,
            texts.domain,
            texts.problem
        );
        assert!(found.cost < best, "plans must improve");
        best = found.cost;
        assert!(
            report.lower_bound <= best + EPSILON,
            "bound {} above a plan of {best}\n{}\n{}",
            report.lower_bound,
            texts.domain,
            texts.problem
        );
    }
    report
}

/// The least makespan of the valid plans of up to `steps` steps on a grid of start times.
fn enumerate(texts: &Texts, domain: &Domain, problem: &Problem, steps: usize) -> Option<f64> {
    let validator = Validator::new(domain, problem, &NoAttachments);
    let mut starts = Vec::new();
    for whole in 0..5 {
        for epsilons in [-2_i32, -1, 0, 1, 2, 3] {
            let start = f64::from(whole) + f64::from(epsilons) * EPSILON;
            if start >= 0.0 {
                starts.push(start);
            }
        }
    }
    let mut best: Option<f64> = None;
    let mut plans = vec![Plan::default()];
    for depth in 0..=steps {
        for plan in &plans {
            if best.is_some_and(|best| plan.makespan() >= best) {
                continue;
            }
            if validator
                .validate(plan, &Options::strict(EPSILON * 0.999))
                .valid()
            {
                best = Some(plan.makespan());
            }
        }
        if depth == steps {
            break;
        }
        let mut longer = Vec::new();
        for plan in &plans {
            let from = plan.steps.last().map_or(0.0, |step| step.start);
            for &start in starts.iter().filter(|start| **start >= from) {
                for (action, duration) in &texts.actions {
                    let mut steps = plan.steps.clone();
                    steps.push(Step {
                        start,
                        action: action.clone(),
                        arguments: Vec::new(),
                        duration: *duration,
                    });
                    longer.push(Plan { steps });
                }
            }
        }
        plans = longer;
    }
    best
}

#[test]
fn every_plan_is_valid() {
    assert!(solved_of(0..500) > 100);
}

/// Takes a minute: `cargo test --release -p planner_core --test search -- --ignored`.
#[test]
#[ignore = "slow"]
fn every_plan_of_thousands_is_valid() {
    assert!(solved_of(500..6_000) > 1_000);
}

/// Solves random tasks, checks every plan, and counts the tasks that had one.
fn solved_of(seeds: std::ops::Range<u64>) -> usize {
    let mut solved = 0;
    for seed in seeds {
        let mix = Mix {
            numbers: seed % 2 == 0,
            timed: seed % 3 == 0,
            conditional: seed % 5 < 2,
            actions: 4 + (seed % 3) as usize,
        };
        let texts = random_task(seed, mix);
        let (domain, problem) = read(&texts);
        solved += usize::from(!checked(&texts, &domain, &problem).plans.is_empty());
    }
    solved
}

#[test]
fn claims_hold_against_enumeration() {
    let (mut optimal, mut unsolvable, mut missed) = (0, 0, 0);
    for seed in 10_000..10_120 {
        let mix = Mix {
            numbers: seed % 2 == 0,
            timed: seed % 5 == 0,
            conditional: false,
            actions: 3,
        };
        let texts = random_task(seed, mix);
        let (domain, problem) = read(&texts);
        let report = checked(&texts, &domain, &problem);
        let truth = enumerate(&texts, &domain, &problem, 2);
        match (report.outcome, truth) {
            (Outcome::ProvenUnsolvable, Some(truth)) => panic!(
                "called unsolvable, but there is a plan of {truth}\n{}\n{}",
                texts.domain, texts.problem
            ),
            (Outcome::ProvenUnsolvable, None) => unsolvable += 1,
            (Outcome::SolvedOptimally, Some(truth)) => {
                optimal += 1;
                let claimed = report.plans.last().map_or(f64::INFINITY, |p| p.cost);
                assert!(
                    claimed <= truth + 0.05,
                    "called {claimed} optimal, but there is a plan of {truth}\n{}\n{}",
                    texts.domain,
                    texts.problem
                );
            }
            (Outcome::Exhausted, Some(_)) => missed += 1,
            _ => {}
        }
    }
    assert!(optimal > 3 && unsolvable > 3, "{optimal} {unsolvable}");
    assert!(missed < 20, "{missed} tasks have a plan that was not found");
}

#[test]
fn the_same_seed_gives_the_same_plans() {
    for seed in 0..20 {
        let mix = Mix {
            numbers: true,
            timed: true,
            conditional: true,
            actions: 5,
        };
        let texts = random_task(seed, mix);
        let (domain, problem) = read(&texts);
        let plans = |report: SolveReport| -> Vec<Plan> {
            report.plans.into_iter().map(|found| found.plan).collect()
        };
        assert_eq!(
            plans(checked(&texts, &domain, &problem)),
            plans(checked(&texts, &domain, &problem))
        );
    }
}
