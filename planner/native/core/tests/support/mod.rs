//! Reading, solving and checking small problems.

#![allow(dead_code)] // each test takes what it needs

use std::time::Duration;

use planner_core::attachment::Attachments;
use planner_core::pddl::model::{Domain, Problem};
use planner_core::pddl::{read_domain, read_problem};
use planner_core::plan::Plan;
use planner_core::solve::{SolveOptions, SolveReport, solve};
use planner_core::syntax::diagnostic::Severity;
use planner_core::syntax::render::render_all;
use planner_core::syntax::source::SourceFile;
use planner_core::validate::{Options, validate};

/// Reads both texts; warnings are no failure.
pub fn read(domain: &str, problem: &str) -> (Domain, Problem) {
    let fine = |diagnostics: &[planner_core::syntax::diagnostic::Diagnostic],
                source: &SourceFile| {
        let errors = diagnostics.iter().any(|d| d.severity == Severity::Error);
        assert!(!errors, "{}", render_all(diagnostics, source, None));
    };
    let source = SourceFile::new("domain.pddl", domain);
    let (domain, diagnostics) = read_domain(&source);
    fine(&diagnostics, &source);
    let domain = domain.expect("a domain");
    let source = SourceFile::new("problem.pddl", problem);
    let (problem, diagnostics) = read_problem(&source, &domain);
    fine(&diagnostics, &source);
    (domain, problem.expect("a problem"))
}

/// Node-limited, so that the clock does not matter.
pub fn options() -> SolveOptions<'static> {
    SolveOptions {
        timeout: Some(Duration::from_secs(60)),
        node_limit: Some(1_500),
        ..SolveOptions::default()
    }
}

/// Solves and has every plan validated.
pub fn solved(
    domain: &Domain,
    problem: &Problem,
    attachments: &dyn Attachments,
    options: &SolveOptions<'_>,
) -> SolveReport {
    let report = solve(domain, problem, attachments, options, &mut |_| {});
    let report = report.unwrap_or_else(|error| panic!("{error}"));
    for found in &report.plans {
        check(domain, problem, attachments, &found.plan);
    }
    report
}

/// Asserts that a plan is valid.
pub fn check(domain: &Domain, problem: &Problem, attachments: &dyn Attachments, plan: &Plan) {
    let verdict = validate(domain, problem, plan, attachments, &Options::strict(0.001));
    assert!(verdict.valid(), "{:?}\n{plan:#?}", verdict.failure);
}
