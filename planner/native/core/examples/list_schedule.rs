//! Optimises one problem in the list-schedule space and prints what it reaches when:
//! `list_schedule DOMAIN PROBLEM SECONDS|LISTSn SEED [PLAN-FILE]` (`5000n`: that many lists).

mod support;

use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use planner_core::schedule::{Limits, Optimiser};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, domain, problem, seconds, seed, ..] = arguments.as_slice() else {
        return Err("usage: list_schedule DOMAIN PROBLEM SECONDS SEED [PLAN-FILE]".into());
    };
    let began = Instant::now();
    let task = support::read_task(domain, problem)?;
    let grounded = began.elapsed();
    let began = Instant::now();
    let Some(mut optimiser) = Optimiser::new(&task, seed.parse()?, None) else {
        println!("unsupported in the list-schedule space");
        return Ok(());
    };
    println!(
        "ground {:.3} s, {} operators, {} facts; compiled in {:.4} s; lower bound {:.3}",
        grounded.as_secs_f64(),
        task.operators.len(),
        task.facts.len(),
        began.elapsed().as_secs_f64(),
        optimiser.lower_bound()
    );
    let cancel = AtomicBool::new(false);
    let limits = Limits {
        deadline: seconds
            .parse()
            .ok()
            .map(|seconds| began + Duration::from_secs_f64(seconds)),
        patience: None,
        cancel: &cancel,
        nodes: seconds.strip_suffix('n').map(str::parse).transpose()?,
    };
    let mut best = None;
    let ending = optimiser.run(None, &limits, &mut |schedule| {
        println!(
            "{:8.4} s  makespan {:.3}  cost {:.3}  {} steps",
            began.elapsed().as_secs_f64(),
            schedule.makespan,
            schedule.cost,
            schedule.operators.len()
        );
        best = Some(schedule.clone());
    });
    let (achieved, settled) = optimiser.exploration_counts();
    println!(
        "{ending:?} after {:.3} s, {} lists, {achieved} achieved, {settled} labels",
        began.elapsed().as_secs_f64(),
        optimiser.nodes(),
    );
    if let (Some(path), Some(best)) = (arguments.get(5), best) {
        let mut text = String::new();
        for step in best.plan(&task).steps {
            text += &format!("{}: ({}", step.start, step.action);
            for argument in &step.arguments {
                text += &format!(" {argument}");
            }
            text += ")";
            if let Some(duration) = step.duration {
                text += &format!(" [{duration}]");
            }
            text += "\n";
        }
        std::fs::write(path, text)?;
    }
    Ok(())
}
