//! Reads and checks a domain file with its problem files.

use super::{Subject, check};
use crate::pddl::model::Problem;
use crate::pddl::{read_domain, read_problem};
use crate::syntax::diagnostic::{Diagnostic, has_errors};
use crate::syntax::source::SourceFile;

/// All diagnostics of the domain, then those of each problem.
///
/// Checks beyond syntax are made only where there is no error; those that need problems only if
/// all problems are without one.
#[must_use]
pub fn check_files(
    domain_file: &SourceFile,
    problem_files: &[&SourceFile],
    providers: Option<&[String]>,
) -> Vec<Vec<Diagnostic>> {
    let (domain, diagnostics) = read_domain(domain_file);
    let mut all = vec![diagnostics];
    let Some(domain) = domain else {
        all.resize(problem_files.len() + 1, Vec::new());
        return all;
    };
    let mut problems: Vec<Problem> = Vec::new();
    let mut faulty = false;
    for file in problem_files {
        let (problem, diagnostics) = read_problem(file, &domain);
        faulty |= has_errors(&diagnostics);
        problems.extend(problem);
        all.push(diagnostics);
    }
    if has_errors(&all[0]) {
        return all;
    }
    let clean: Vec<&Problem> = if faulty {
        Vec::new()
    } else {
        problems.iter().collect()
    };
    let findings = check(&Subject {
        domain: &domain,
        problems: &clean,
        providers,
    });
    all[0].extend(findings.domain);
    for (found, more) in all[1..].iter_mut().zip(findings.problems) {
        found.extend(more);
    }
    for found in &mut all {
        found.sort_by_key(|one| (one.span, one.code.number()));
    }
    all
}
