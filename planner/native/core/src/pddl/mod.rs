//! The typed model of a domain and a problem, and the reader that fills it.
//!
//! ```
//! use planner_core::pddl::{read_domain, read_problem};
//! use planner_core::syntax::source::SourceFile;
//!
//! let text = "(define (domain d) (:predicates (p)) (:action a :parameters () :effect (p)))";
//! let (domain, diagnostics) = read_domain(&SourceFile::new("d.pddl", text));
//! assert!(diagnostics.is_empty());
//! let text = "(define (problem x) (:domain d) (:init) (:goal (p)))";
//! let (problem, _) = read_problem(&SourceFile::new("p.pddl", text), &domain.unwrap());
//! assert_eq!(problem.unwrap().name.text, "x");
//! ```

pub mod model;
mod reader;

pub(crate) use reader::supported_flags;
pub use reader::{read_domain, read_domain_tree, read_problem, read_problem_tree};

/// ` ?r - robot ?a - (either b c)`: parameters as they are written, a blank before each.
#[must_use]
pub fn parameter_list(domain: &model::Domain, parameters: &[model::Parameter]) -> String {
    parameters
        .iter()
        .map(|parameter| {
            let types: Vec<&str> = parameter
                .types
                .iter()
                .map(|kind| domain.types[kind.index()].name.text.as_str())
                .collect();
            match types.as_slice() {
                ["object"] => format!(" {}", parameter.name.text),
                [one] => format!(" {} - {one}", parameter.name.text),
                several => format!(" {} - (either {})", parameter.name.text, several.join(" ")),
            }
        })
        .collect()
}
