//! Expansions of the decision-epoch search alone, heuristic included:
//! `epoch_rate DOMAIN PROBLEM SECONDS [HEURISTIC]`, for profiling.

mod support;

use std::error::Error;
use std::time::{Duration, Instant};

use planner_core::attachment::NoAttachments;
use planner_core::epoch::calls::Calls;
use planner_core::epoch::compiled::Compiled;
use planner_core::epoch::completeness::analyse;
use planner_core::epoch::registry::Dominance;
use planner_core::epoch::search::{Parameters, Search, Status};
use planner_core::epoch::successors::Successors;
use planner_core::epoch::transitions::Transitions;
use planner_core::heuristic::choice::Choice;
use planner_core::heuristic::relaxed::RelaxedTask;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, domain, problem, seconds, ..] = arguments.as_slice() else {
        return Err("usage: epoch_rate DOMAIN PROBLEM SECONDS [HEURISTIC]".into());
    };
    let task = support::read_task(domain, problem)?;
    let compiled = Compiled::new(&task);
    let relaxed = RelaxedTask::new(&task);
    let successors = Successors::new(&compiled);
    let calls = Calls::new(&task, &NoAttachments);
    let transitions = Transitions {
        compiled: &compiled,
        calls: &calls,
    };
    let dominance = if analyse(&task).earlier_is_better {
        Dominance::Earlier
    } else {
        Dominance::Shifted
    };
    let parameters = Parameters {
        time_weight: 0.0,
        seed: 0,
        dominance,
        tolerance: 0.02,
        memory: 2 << 30,
    };
    let name = arguments.get(4).map_or("temporal-ff", String::as_str);
    let choice = Choice::named(name).ok_or("no such heuristic")?;
    let graphs = choice.graphs(&|| false, &task, &relaxed);
    let heuristics = choice.heuristics(&compiled, &relaxed, graphs.as_ref());
    let mut search = Search::new(transitions, &successors, heuristics, parameters);
    let begun = Instant::now();
    let begun_cpu_s = cpu_s();
    let limit = Duration::from_secs_f64(seconds.parse()?);
    loop {
        let mut best = f64::INFINITY;
        let status = search.run(
            u64::MAX >> 1,
            &mut || begun.elapsed() > limit,
            &mut |found| best = found.cost,
        );
        if status != Status::Found {
            println!("{status:?}");
            break;
        }
        println!("{:.3} s {best:.3}", begun.elapsed().as_secs_f64());
    }
    let elapsed_s = cpu_s() - begun_cpu_s;
    println!(
        "{:.0} a CPU second, {:?} {} MB",
        search.statistics.expansions as f64 / elapsed_s,
        search.statistics,
        search.memory() >> 20
    );
    Ok(())
}

/// CPU time of this process [s]; 0 where the system does not tell.
fn cpu_s() -> f64 {
    let schedule = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    let nanoseconds = schedule
        .split(' ')
        .next()
        .and_then(|text| text.parse().ok());
    nanoseconds.map_or(0.0, |nanoseconds: f64| nanoseconds * 1e-9)
}
