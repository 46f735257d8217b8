//! Plans cross the border as lists of `(start, action, arguments, duration)`.

use planner_core::plan::{Plan, Step, reader, writer};
use planner_core::syntax::source::SourceFile;
use pyo3::prelude::*;

use crate::diagnostic::{Diagnostic, convert};
use crate::model::Problem;
use crate::panic;

/// Start [s], action, arguments, duration [s] (`None` for an instantaneous action).
pub type StepTuple = (f64, String, Vec<String>, Option<f64>);

/// To Python.
pub fn to_tuples(plan: &Plan) -> Vec<StepTuple> {
    plan.steps
        .iter()
        .map(|step| {
            (
                step.start,
                step.action.clone(),
                step.arguments.clone(),
                step.duration,
            )
        })
        .collect()
}

/// From Python.
pub fn from_tuples(steps: Vec<StepTuple>) -> Plan {
    Plan {
        steps: steps
            .into_iter()
            .map(|(start, action, arguments, duration)| Step {
                start,
                action,
                arguments,
                duration,
            })
            .collect(),
    }
}

/// Reads plan text; `None` where a diagnostic is an error.
#[pyfunction]
pub fn read_plan(
    py: Python<'_>,
    problem: &Problem,
    text: &[u8],
    name: &str,
) -> PyResult<(Option<Vec<StepTuple>>, Vec<Diagnostic>)> {
    let source = SourceFile::from_bytes(name, text);
    let domain = &problem.domain.get().model;
    let (plan, diagnostics) =
        panic::detached(py, || reader::read(&source, domain, &problem.model))?;
    Ok((
        plan.as_ref().map(to_tuples),
        convert(&diagnostics, &source, None),
    ))
}

/// Writes plan text.
#[pyfunction]
#[pyo3(signature = (steps, *, domain=None, problem=None, evaluated=None, metric=None))]
pub fn write_plan(
    steps: Vec<StepTuple>,
    domain: Option<&str>,
    problem: Option<&str>,
    evaluated: Option<u64>,
    metric: Option<f64>,
) -> String {
    let around = writer::Surroundings {
        domain,
        problem,
        evaluated,
        metric,
    };
    writer::write(&from_tuples(steps), &around)
}
