//! Every file of the competition suites and of the project's own instances reads without an error.
//!
//! The files lie outside the project; where they are absent the test says so and passes.

use std::fs;
use std::path::{Path, PathBuf};

use planner_core::pddl::{read_domain, read_problem};
use planner_core::syntax::diagnostic::{Diagnostic, Severity};
use planner_core::syntax::render::render;
use planner_core::syntax::source::SourceFile;

fn suites() -> Option<Vec<PathBuf>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data");
    let mut folders = Vec::new();
    for year in ["ipc/ipc-2008/domains", "ipc/ipc-2011/domains", "instances"] {
        let entries = fs::read_dir(root.join(year)).ok()?;
        folders.extend(entries.filter_map(|entry| Some(entry.ok()?.path())));
    }
    folders.sort();
    Some(folders)
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "pddl")
        })
        .collect();
    files.sort();
    files
}

/// The domain that belongs to a problem: one for the folder, or one for each problem.
fn domain_of(problem: &Path, suite: &Path) -> PathBuf {
    let number = problem
        .file_stem()
        .and_then(|stem| stem.to_str()?.rsplit('-').next())
        .unwrap_or_default();
    let own = suite.join(format!("domains/domain-{number}.pddl"));
    if own.exists() {
        own
    } else {
        suite.join("domain.pddl")
    }
}

fn first_error(diagnostics: &[Diagnostic], file: &SourceFile) -> Option<String> {
    diagnostics
        .iter()
        .find(|diagnostic| diagnostic.severity == Severity::Error)
        .map(|diagnostic| render(diagnostic, file, None))
}

#[test]
fn every_file_reads_without_an_error() {
    let Some(suites) = suites() else {
        eprintln!("skipped: ../shared/data is absent");
        return;
    };
    let mut count = 0;
    for suite in suites {
        if suite.to_string_lossy().contains("net-benefit") {
            continue; // preferences, which are refused
        }
        let mut problems = files(&suite.join("instances"));
        if problems.is_empty() {
            problems = files(&suite);
            problems.retain(|path| !path.ends_with("domain.pddl"));
        }
        assert!(!problems.is_empty(), "no problems in {}", suite.display());
        for path in problems {
            let domain_path = domain_of(&path, &suite);
            let source = SourceFile::from_bytes(
                domain_path.to_string_lossy(),
                &fs::read(&domain_path).unwrap(),
            );
            let (domain, diagnostics) = read_domain(&source);
            assert_eq!(first_error(&diagnostics, &source), None);
            let source = SourceFile::from_bytes(path.to_string_lossy(), &fs::read(&path).unwrap());
            let (problem, diagnostics) = read_problem(&source, &domain.unwrap());
            assert_eq!(first_error(&diagnostics, &source), None);
            assert!(!problem.unwrap().facts.is_empty());
            count += 1;
        }
    }
    assert!(count > 600, "only {count} problems were read");
}
