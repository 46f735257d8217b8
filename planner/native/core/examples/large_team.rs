//! First plans for large teams whose ways are attachments:
//! `large_team EXPLORERS CLEARERS TARGETS BLOCKADES SECONDS [SEED]`.
//!
//! Places lie at random on a square; a way is the distance at 1 m/s, 2 m/s for clearers. One target
//! in ten is walled off and can be reached from one blockade only.

use std::error::Error;
use std::fmt::Write as _;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use planner_core::attachment::{Arguments, Attachments, Purity, StateView};
use planner_core::pddl::model::ModuleId;
use planner_core::pddl::{read_domain, read_problem};
use planner_core::solve::{SolveOptions, solve};
use planner_core::syntax::source::SourceFile;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashMap;

const DOMAIN: &str = include_str!("../../../../domains/disaster/domain.pddl");
const SIDE_M: f64 = 1_000.0;

struct Ways {
    place_m: FxHashMap<String, (f64, f64)>,
    /// Walled-off targets and the blockade in front of each.
    behind: FxHashMap<String, String>,
    calls: AtomicUsize,
}

impl Attachments for Ways {
    fn purity(&self, _: ModuleId) -> Purity {
        Purity::Arguments
    }

    fn evaluate(
        &self,
        module: ModuleId,
        calls: &[Arguments],
        _: Option<&dyn StateView>,
    ) -> Result<Vec<f64>, (usize, String)> {
        self.calls.fetch_add(calls.len(), Ordering::Relaxed);
        Ok(calls
            .iter()
            .map(|call| {
                if module.index() == 1 {
                    return 100.0;
                }
                let (robot, from, to) = (&call[0], &call[1], &call[2]);
                let shut = |one: &String, other: &String| {
                    self.behind.get(one).is_some_and(|gate| gate != other)
                };
                if shut(to, from) || shut(from, to) {
                    return f64::INFINITY;
                }
                let (one, other) = (self.place_m[from], self.place_m[to]);
                let speed = if robot.starts_with('c') { 2.0 } else { 1.0 };
                (1.0 + (one.0 - other.0).hypot(one.1 - other.1) / speed).round()
            })
            .collect())
    }

    fn apply(
        &self,
        _: ModuleId,
        _: &Arguments,
        _: &dyn StateView,
    ) -> Result<Option<Vec<f64>>, String> {
        Err("no effects".into())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers: Vec<f64> = std::env::args()
        .skip(1)
        .map(|text| text.parse())
        .collect::<Result<_, _>>()?;
    let [explorers, clearers, targets, blockades, seconds, rest @ ..] = numbers.as_slice() else {
        return Err("usage: large_team EXPLORERS CLEARERS TARGETS BLOCKADES SECONDS [SEED]".into());
    };
    let mut random = ChaCha8Rng::seed_from_u64(rest.first().map_or(0, |seed| *seed as u64));
    let mut ways = Ways {
        place_m: FxHashMap::default(),
        behind: FxHashMap::default(),
        calls: AtomicUsize::new(0),
    };
    let mut objects = String::new();
    let mut init = String::new();
    let mut goal = String::new();
    let (blockades, targets) = (*blockades as usize, *targets as usize);
    for (letter, kind, count) in [
        ('e', "explorer", *explorers as usize),
        ('c', "clearer", *clearers as usize),
        ('t', "mission_target", targets),
        ('b', "blockade", blockades),
    ] {
        for index in 0..count {
            let name = format!("{letter}{index}");
            let _ = write!(objects, "{name} - {kind} ");
            let mut place = name.clone();
            if kind == "explorer" || kind == "clearer" {
                place = format!("start-{name}");
                let _ = write!(objects, "{place} - free_location ");
                let _ = write!(init, "(at {name} {place}) ");
            }
            if kind == "mission_target" {
                let _ = write!(goal, "(explored {name}) ");
                if index % 10 == 9 && blockades > 0 {
                    ways.behind
                        .insert(name.clone(), format!("b{}", index % blockades));
                }
            }
            let at = (
                random.random_range(0.0..SIDE_M),
                random.random_range(0.0..SIDE_M),
            );
            ways.place_m.insert(place, at);
        }
    }
    let text = format!(
        "(define (problem p) (:domain disaster) (:objects {objects}) (:init {init}) (:goal (and {goal})))"
    );
    let begun = Instant::now();
    let (domain, diagnostics) = read_domain(&SourceFile::new("domain", DOMAIN));
    let domain = domain.ok_or_else(|| format!("{diagnostics:?}"))?;
    let (problem, diagnostics) = read_problem(&SourceFile::new("problem", text), &domain);
    let problem = problem.ok_or_else(|| format!("{diagnostics:?}"))?;
    let options = SolveOptions {
        timeout: Some(Duration::from_secs_f64(*seconds)),
        ..SolveOptions::default()
    };
    let report = solve(&domain, &problem, &ways, &options, &mut |plan| {
        println!(
            "{:.3} s: {:.1}",
            begun.elapsed().as_secs_f64(),
            plan.makespan()
        );
    })?;
    println!(
        "{:?} ground {:.3} s, {} operators, {} facts, {} calls, {} lists",
        report.outcome,
        report.grounding_s,
        report.operators,
        report.facts,
        ways.calls.load(Ordering::Relaxed),
        report.schedules
    );
    Ok(())
}
