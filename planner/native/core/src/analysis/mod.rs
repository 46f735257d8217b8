//! Checks beyond syntax: what reads well and still does not say what was meant.
//!
//! ```text
//! usage        who reads, writes and mentions what      -> unused, effects nothing reads, never true
//! invariants   over-all conditions against own effects
//! durations    zero, negative, infinite
//! providers    modules that nobody computes
//! relaxation   delete relaxation of each problem        -> actions that never apply, impossible durations
//! goals        what that relaxation never reaches       -> unreachable goals
//! ```

mod completion;
mod durations;
mod files;
mod goals;
mod invariants;
mod occurrence;
mod providers;
mod relaxation;
mod unused;
mod usage;
mod walk;

use crate::pddl::model::{Domain, Problem};
use crate::syntax::diagnostic::{Diagnostic, Diagnostics};

pub use completion::{Completion, completions};
pub use files::check_files;
pub use occurrence::{Occurrence, SymbolKind, occurrences};

/// What is checked together.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The domain.
    pub domain: &'a Domain,
    /// Problems of it; findings that need a problem are given only if there is one.
    pub problems: &'a [&'a Problem],
    /// Names of the attachments that can be computed, if that is known.
    pub providers: Option<&'a [String]>,
}

/// Findings by file.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// In the domain.
    pub domain: Vec<Diagnostic>,
    /// In each problem, in the order given.
    pub problems: Vec<Vec<Diagnostic>>,
}

/// Runs all checks on files that were read without an error.
#[must_use]
pub fn check(subject: &Subject<'_>) -> Findings {
    let mut domain = Diagnostics::default();
    let mut problems: Vec<Diagnostics> = vec![Diagnostics::default(); subject.problems.len()];
    unused::check(subject, &mut domain, &mut problems);
    invariants::check(subject.domain, &mut domain);
    durations::check(subject, &mut domain, &mut problems);
    providers::check(subject, &mut domain);
    relaxation::check(subject, &mut domain, &mut problems);
    Findings {
        domain: domain.finish(),
        problems: problems.into_iter().map(Diagnostics::finish).collect(),
    }
}
