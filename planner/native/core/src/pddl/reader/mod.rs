//! Reads the lossless tree into the typed model; reports every fault of a file in one run.
//!
//! Sections may stand in any order. A faulty part is left out of the model and reported, so that
//! an editor still gets a model of the rest; a planner must refuse a file with any error.

mod action;
mod arguments;
mod condition;
mod declarations;
mod definition;
mod domain;
mod duration;
mod effect;
mod expression;
mod init;
mod modules;
mod names;
mod problem;
mod requirements;
mod scope;
mod sink;
mod time;
mod typed_list;
mod types;

pub(crate) use requirements::supported_flags;

use crate::pddl::model::{Domain, Problem};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::SourceFile;
use crate::syntax::tree::Tree;

/// Reads a domain. `None` only if the file holds no domain definition; otherwise the model of
/// all that could be read. It may be planned with only if no diagnostic is an error
/// ([`crate::syntax::diagnostic::has_errors`]).
#[must_use]
pub fn read_domain(source: &SourceFile) -> (Option<Domain>, Vec<Diagnostic>) {
    read_domain_tree(&Tree::new(source))
}

/// Reads a problem against its domain; see [`read_domain`].
#[must_use]
pub fn read_problem(source: &SourceFile, domain: &Domain) -> (Option<Problem>, Vec<Diagnostic>) {
    read_problem_tree(&Tree::new(source), domain)
}

/// [`read_domain`] for a tree that exists already; its diagnostics are included.
#[must_use]
pub fn read_domain_tree(tree: &Tree) -> (Option<Domain>, Vec<Diagnostic>) {
    domain::read(tree)
}

/// [`read_problem`] for a tree that exists already; its diagnostics are included.
#[must_use]
pub fn read_problem_tree(tree: &Tree, domain: &Domain) -> (Option<Problem>, Vec<Diagnostic>) {
    problem::read(tree, domain)
}
