//! What the examples share: a task from two files, for measurements without Python.

use std::error::Error;

use planner_core::attachment::NoAttachments;
use planner_core::grounding::{GroundingLimits, ground};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::syntax::diagnostic::{Diagnostic, Severity};
use planner_core::syntax::source::SourceFile;
use planner_core::task::Task;

/// Reads and grounds a problem without attachments; any fault in the files is an error.
pub fn read_task(domain: &str, problem: &str) -> Result<Task, Box<dyn Error>> {
    let (domain, diagnostics) = read_domain(&source(domain)?);
    let domain = domain.ok_or_else(|| format!("{diagnostics:?}"))?;
    accept(&diagnostics)?;
    let (problem, diagnostics) = read_problem(&source(problem)?, &domain);
    let problem = problem.ok_or_else(|| format!("{diagnostics:?}"))?;
    accept(&diagnostics)?;
    let limits = GroundingLimits::default();
    Ok(ground(&domain, &problem, &NoAttachments, &limits)?)
}

fn source(path: &str) -> Result<SourceFile, Box<dyn Error>> {
    Ok(SourceFile::new(
        path.to_owned(),
        std::fs::read_to_string(path)?,
    ))
}

fn accept(diagnostics: &[Diagnostic]) -> Result<(), Box<dyn Error>> {
    if diagnostics.iter().any(|d| d.severity == Severity::Error) {
        return Err(format!("{diagnostics:?}").into());
    }
    Ok(())
}
