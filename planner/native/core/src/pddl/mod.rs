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

pub use reader::{read_domain, read_domain_tree, read_problem, read_problem_tree};
