//! Solves a problem file and prints every improving plan: `solve DOMAIN PROBLEM [SECONDS] [PLAN]`.
//!
//! For profiling the core without Python; attachments are not available. With `CPU` set, seconds are
//! those that the searching thread was on a processor (Linux), whatever else the machine does.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use planner_core::attachment::NoAttachments;
use planner_core::pddl::{read_domain, read_problem};
use planner_core::plan::Plan;
use planner_core::solve::{SolveOptions, solve};
use planner_core::syntax::diagnostic::{Diagnostic, Severity};
use planner_core::syntax::source::SourceFile;

fn refused(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|d| d.severity == Severity::Error)
}

/// How long the main thread has been on a processor [s].
fn processor_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/schedstat").ok()?;
    let nanoseconds: f64 = text.split(' ').next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [domain_path, problem_path, rest @ ..] = arguments.as_slice() else {
        return Err("usage: solve DOMAIN PROBLEM [SECONDS] [PLAN]".into());
    };
    let seconds: f64 = rest.first().map_or(Ok(10.0), |text| text.parse())?;
    let counts_cpu = std::env::var("CPU").is_ok();
    static CANCEL: AtomicBool = AtomicBool::new(false);
    if counts_cpu {
        std::thread::spawn(move || {
            while processor_s().is_some_and(|spent| spent < seconds) {
                std::thread::sleep(Duration::from_millis(20));
            }
            CANCEL.store(true, Ordering::Relaxed);
        });
    }
    let begun = Instant::now();
    let elapsed_s = || {
        let spent = processor_s().filter(|_| counts_cpu);
        spent.unwrap_or_else(|| begun.elapsed().as_secs_f64())
    };
    let text = std::fs::read_to_string(domain_path)?;
    let (domain, diagnostics) = read_domain(&SourceFile::new(domain_path, text.as_str()));
    let domain = domain.filter(|_| !refused(&diagnostics));
    let domain = domain.ok_or_else(|| format!("{diagnostics:?}"))?;
    let text = std::fs::read_to_string(problem_path)?;
    let (problem, diagnostics) =
        read_problem(&SourceFile::new(problem_path, text.as_str()), &domain);
    let problem = problem.filter(|_| !refused(&diagnostics));
    let problem = problem.ok_or_else(|| format!("{diagnostics:?}"))?;
    let read_s = elapsed_s();
    let options = SolveOptions {
        timeout: (!counts_cpu).then(|| Duration::from_secs_f64(seconds)),
        cancel: Some(&CANCEL),
        seed: std::env::var("SEED").map_or(0, |seed| seed.parse().unwrap_or(0)),
        threads: std::env::var("THREADS").map_or(1, |count| count.parse().unwrap_or(1)),
        first_plan_only: std::env::var("FIRST").is_ok(),
        ..SolveOptions::default()
    };
    let mut best = Plan::default();
    let report = solve(&domain, &problem, &NoAttachments, &options, &mut |plan| {
        println!("{:.3} {:.3}", elapsed_s(), plan.makespan());
        best = plan.clone();
    })?;
    println!(
        "{:?} read {read_s:.3} ground {:.3} operators {} facts {} bound {:.3} expansions {} ({:.0}/s) schedules {}",
        report.outcome,
        report.grounding_s,
        report.operators,
        report.facts,
        report.lower_bound,
        report.expansions,
        report.expansions as f64 / elapsed_s(),
        report.schedules,
    );
    if let (Some(path), false) = (rest.get(1), best.steps.is_empty()) {
        let mut text = String::new();
        for step in &best.steps {
            let name = [std::slice::from_ref(&step.action), &step.arguments]
                .concat()
                .join(" ");
            match step.duration {
                Some(duration) => text += &format!("{}: ({name}) [{duration}]\n", step.start),
                None => text += &format!("{}: ({name})\n", step.start),
            }
        }
        std::fs::write(path, text)?;
    }
    Ok(())
}
