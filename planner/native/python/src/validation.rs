//! Validation as Python sees it.

use planner_core::validate::{self as core, Options, Reason};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::attachments::{FailedCall, PythonAttachments, failed_call};
use crate::model::Problem;
use crate::panic;
use crate::plan::{StepTuple, from_tuples};

/// What validation found.
#[pyclass(frozen, get_all, module = "planner._core")]
pub struct Verdict {
    valid: bool,
    makespan: f64,
    metric: Option<f64>,
    reason: Option<&'static str>,
    message: Option<String>,
    time: Option<f64>,
    happening: Option<usize>,
    step: Option<usize>,
    facts: Vec<String>,
    report: Vec<String>,
    /// The attachment that failed.
    attachment: Option<FailedCall>,
}

impl From<core::Verdict> for Verdict {
    fn from(verdict: core::Verdict) -> Self {
        let failure = verdict.failure.as_ref();
        Self {
            valid: verdict.valid(),
            makespan: verdict.makespan,
            metric: verdict.metric,
            reason: failure.map(|one| one.reason.code()),
            message: failure.map(ToString::to_string),
            time: failure.and_then(|one| one.time),
            happening: failure.and_then(|one| one.happening),
            step: failure.and_then(|one| one.step),
            facts: failure.map(|one| one.facts.clone()).unwrap_or_default(),
            attachment: failure.and_then(|one| match &one.reason {
                Reason::Attachment(error) => Some(failed_call(error)),
                _ => None,
            }),
            report: verdict.report,
        }
    }
}

/// Validates a plan; gives the verdict and the exception of an attachment that failed.
#[pyfunction]
pub fn validate(
    py: Python<'_>,
    problem: &Problem,
    steps: Vec<StepTuple>,
    attachments: &Bound<'_, PyDict>,
    tolerance_s: f64,
    separation_s: f64,
    report: bool,
) -> PyResult<(Verdict, Option<PyErr>)> {
    let domain = &problem.domain.get().model;
    let attachments = PythonAttachments::new(attachments, domain, &problem.model)?;
    let options = Options {
        tolerance_s,
        separation_s,
        report,
    };
    let plan = from_tuples(steps);
    let verdict = panic::detached(py, || {
        core::validate(domain, &problem.model, &plan, &attachments, &options)
    })?;
    Ok((verdict.into(), attachments.exception()))
}
