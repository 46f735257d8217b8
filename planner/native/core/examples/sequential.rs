//! First plan of one action after the other: `sequential DOMAIN PROBLEM SECONDS [HEURISTIC|novelty]`, for measurements.

mod support;

use std::error::Error;
use std::time::{Duration, Instant};

use planner_core::attachment::NoAttachments;
use planner_core::epoch::calls::Calls;
use planner_core::epoch::compiled::Compiled;
use planner_core::epoch::completeness::analyse;
use planner_core::epoch::registry::Dominance;
use planner_core::epoch::search::{Parameters, Search};
use planner_core::epoch::successors::Successors;
use planner_core::epoch::transitions::Transitions;
use planner_core::heuristic::choice::Choice;
use planner_core::heuristic::relaxed::RelaxedTask;
use planner_core::sequential::compression::compress;
use planner_core::sequential::width::WidthSearch;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, domain, problem, seconds, ..] = arguments.as_slice() else {
        return Err("usage: sequential DOMAIN PROBLEM SECONDS [HEURISTIC]".into());
    };
    let task = support::read_task(domain, problem)?;
    println!("{:?}", analyse(&task));
    let task = compress(&task).ok_or("not compressible")?;
    let compiled = Compiled::new(&task);
    let relaxed = RelaxedTask::new(&task);
    let successors = Successors::new(&compiled);
    let calls = Calls::new(&task, &NoAttachments);
    let transitions = Transitions {
        compiled: &compiled,
        calls: &calls,
    };
    let parameters = Parameters {
        time_weight: 0.0,
        seed: 0,
        dominance: Dominance::Untimed,
        tolerance: 0.0,
        memory: 2 << 30,
    };
    let symmetry = planner_core::sequential::symmetry::Symmetry::new(&task);
    let name = arguments.get(4).map_or("temporal-ff", String::as_str);
    let limit = Duration::from_secs_f64(seconds.parse()?);
    if name == "novelty" {
        let begun = Instant::now();
        let mut search = WidthSearch::new(transitions, &successors, &relaxed, 2 << 30);
        if let Some(symmetry) = &symmetry {
            search.tell_apart_by(Box::new(|state| symmetry.fingerprint(state)));
        }
        let mut steps = 0;
        let status = search.run(
            u64::MAX >> 1,
            &mut || begun.elapsed() > limit,
            &mut |found| steps = found.steps.len(),
        );
        println!(
            "{status:?} {steps} steps, {:.2} wall s, {:?}",
            begun.elapsed().as_secs_f64(),
            search.statistics
        );
        return Ok(());
    }
    let choice = Choice::named(name).ok_or("no such heuristic")?;
    let graphs = choice.graphs(&|| false, &task, &relaxed);
    let heuristics = choice.heuristics(&compiled, &relaxed, graphs.as_ref());
    let mut search = Search::new(transitions, &successors, heuristics, parameters);
    let begun = Instant::now();
    if let Some(symmetry) = &symmetry {
        println!(
            "classes {:?} after {:.3} s",
            symmetry.classes,
            begun.elapsed().as_secs_f64()
        );
        search.tell_apart_by(Box::new(|state| symmetry.fingerprint(state)));
    }
    let mut steps = 0;
    let status = search.run(
        u64::MAX >> 1,
        &mut || begun.elapsed() > limit,
        &mut |found| steps = found.steps.len(),
    );
    println!(
        "{status:?} {steps} steps, {:.2} wall s, operators {} relaxed {} {:?}",
        begun.elapsed().as_secs_f64(),
        task.operators.len(),
        relaxed.actions.len(),
        search.statistics
    );
    Ok(())
}
