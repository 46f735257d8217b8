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
use state::State;

/// How strictly to validate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// VAL's `-t` [s]: durations may be off by as much, and everything within a tenth of it is one happening.
    pub tolerance_s: f64,
    /// Smallest time between happenings that interfere [s], to within a tenth of the tolerance; 0 asks it
    /// within one happening only, as VAL does.
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

    /// Occurrences this near to the first one of a happening belong to it [s].
    pub(super) fn together_s(&self) -> f64 {
        self.tolerance_s / 10.0
    }

    /// Smallest time between the first occurrences of happenings that interfere [s]. The first one
    /// of a happening may be earlier than the one that keeps its distance.
    pub(super) fn least_gap_s(&self) -> f64 {
        (self.separation_s - self.together_s()).max(0.0)
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
    Validator::new(domain, problem, attachments).validate(plan, options)
}

/// Validates plans of one problem; what does not depend on the plan is prepared once.
pub struct Validator<'a> {
    names: Names<'a>,
    scene: Result<Scene<'a>, scene::Fault>,
    initial: State,
}

impl<'a> Validator<'a> {
    /// Prepares for a problem.
    #[must_use]
    pub fn new(domain: &'a Domain, problem: &'a Problem, attachments: &'a dyn Attachments) -> Self {
        Self {
            names: Names::new(domain, problem),
            scene: Scene::new(domain, problem, attachments),
            initial: State::initial(domain, problem),
        }
    }

    /// Validates a plan.
    #[must_use]
    pub fn validate(&self, plan: &Plan, options: &Options) -> Verdict {
        let mut report = Vec::new();
        let outcome = self.execute(plan, options, &mut report);
        let (metric, failure) = match outcome {
            Ok(metric) => (metric, None),
            Err(failure) => (None, Some(*failure)),
        };
        Verdict {
            makespan: plan.makespan(),
            metric,
            failure,
            report,
        }
    }

    /// Executes a plan; gives the value of the metric.
    fn execute(
        &self,
        plan: &Plan,
        options: &Options,
        report: &mut Vec<String>,
    ) -> Result<Option<f64>, Box<Failure>> {
        let outside_time = |fault: scene::Fault| Box::new(Failure::outside_time(fault.into()));
        let scene = self
            .scene
            .as_ref()
            .map_err(|fault| outside_time(fault.clone()))?;
        let steps = resolve::resolve(&self.names, plan)?;
        let occurrences = occurrences(scene.problem, &steps);
        let mut run = Run::new(scene, &steps, self.initial.clone(), options);
        let outcome = (|| {
            run.begin()?;
            for happening in &timeline::happenings(occurrences, options.together_s()) {
                run.step(happening)?;
            }
            run.check_goal()
        })();
        report.append(&mut run.report);
        outcome?;
        let Some(metric) = &scene.problem.metric else {
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
}

/// Everything that occurs at some time, timed initial literals first.
fn occurrences(problem: &Problem, steps: &[resolve::GroundStep<'_>]) -> Vec<(f64, Occurrence)> {
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
    occurrences
}
