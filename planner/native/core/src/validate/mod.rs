//! Validates plans: executes them on the typed model and tells of the first thing that is wrong.
//!
//! The semantics are those of PDDL 2.1 levels 1-3 with timed initial literals, derived predicates and
//! PDDL/M modules, as VAL interprets them (docs/validator.md lists every difference). Nothing here is
//! shared with grounding or search: steps are substituted into the actions as written.
//!
//! Source: Fox and Long, "PDDL2.1: an extension to PDDL for expressing temporal planning domains",
//! JAIR 20, 2003, section 8; Howey, Long, Fox, "VAL: automatic plan validation, continuous effects
//! and mixed initiative planning using PDDL", ICTAI 2004.

mod derived;
mod effects;
mod evaluate;
mod explain;
mod interference;
mod needs;
mod resolve;
mod run;
mod scene;
mod state;
mod text;
mod timeline;
mod types;
mod verdict;

pub(crate) use resolve::Names;
pub use timeline::Occurrence;
pub use verdict::{Failure, Reason, Verdict};

use crate::attachment::Attachments;
use crate::pddl::model::{Domain, Problem};
use crate::plan::Plan;
use run::Run;
use scene::{Moment, Scene};

/// How strictly to validate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// VAL's `-t` [s]: durations may be off by as much, and everything within a tenth of it is one happening.
    pub tolerance_s: f64,
    /// Smallest time between happenings that interfere [s]; 0 asks it within one happening only, as VAL does.
    pub separation_s: f64,
    /// Whether the verdict tells of every check and change.
    pub report: bool,
}

impl Default for Options {
    /// VAL's rules with a tolerance of a millisecond.
    fn default() -> Self {
        Self {
            tolerance_s: 0.001,
            separation_s: 0.0,
            report: false,
        }
    }
}

impl Options {
    /// For our own plans: exact durations, and interfering happenings `separation_s` apart.
    #[must_use]
    pub fn strict(separation_s: f64) -> Self {
        Self {
            tolerance_s: 1e-6,
            separation_s,
            report: false,
        }
    }
}

/// Validates a plan.
#[must_use]
pub fn validate(
    domain: &Domain,
    problem: &Problem,
    plan: &Plan,
    attachments: &dyn Attachments,
    options: &Options,
) -> Verdict {
    let makespan = plan.makespan();
    let mut report = Vec::new();
    match execute(domain, problem, plan, attachments, options, &mut report) {
        Ok(metric) => Verdict {
            makespan,
            metric,
            failure: None,
            report,
        },
        Err(failure) => Verdict {
            makespan,
            metric: None,
            failure: Some(*failure),
            report,
        },
    }
}

fn execute(
    domain: &Domain,
    problem: &Problem,
    plan: &Plan,
    attachments: &dyn Attachments,
    options: &Options,
    report: &mut Vec<String>,
) -> Result<Option<f64>, Box<Failure>> {
    let outside_time = |fault: scene::Fault| Box::new(Failure::outside_time(fault.into()));
    let scene = Scene::new(domain, problem, attachments).map_err(outside_time)?;
    let steps = resolve::resolve(domain, problem, plan)?;
    let mut occurrences = Vec::with_capacity(2 * steps.len() + problem.timed.len());
    for (index, literal) in problem.timed.iter().enumerate() {
        occurrences.push((literal.time, Occurrence::Timed(index)));
    }
    for (index, step) in steps.iter().enumerate() {
        occurrences.push((step.start, Occurrence::Start(index)));
        if step.duration.is_some() {
            occurrences.push((step.end(), Occurrence::End(index)));
        }
    }
    let mut run = Run::new(&scene, &steps, options);
    let outcome = (|| {
        run.begin()?;
        for happening in &timeline::happenings(occurrences, options.tolerance_s) {
            run.step(happening)?;
        }
        run.check_goal()
    })();
    report.append(&mut run.report);
    outcome?;
    let Some(metric) = &problem.metric else {
        return Ok(None);
    };
    let moment = Moment {
        state: &run.state,
        duration: None,
        total_time: plan.makespan(),
        action: "(:metric)",
    };
    scene
        .value(&moment, &metric.expression, &[])
        .map(Some)
        .map_err(outside_time)
}
