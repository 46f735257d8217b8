//! Time to read a problem with a million numeric facts: `cargo run --release --example read_speed`.

use std::fmt::Write as _;
use std::time::Instant;

use planner_core::pddl::{read_domain, read_problem};
use planner_core::syntax::source::SourceFile;

fn main() {
    let domain = "(define (domain d) (:requirements :numeric-fluents) (:functions (f ?a ?b)))";
    let (domain, _) = read_domain(&SourceFile::new("d.pddl", domain));
    let domain = domain.expect("the domain is in order");
    let mut text = String::from("(define (problem p) (:domain d) (:objects");
    for object in 0..1000 {
        let _ = write!(text, " o{object}");
    }
    text.push_str(")\n(:init");
    for first in 0..1000 {
        for second in 0..1000 {
            let _ = writeln!(text, "(= (f o{first} o{second}) {second})");
        }
    }
    text.push_str(") (:goal (and)))");
    let megabytes = text.len() / 1_000_000;
    let start = Instant::now();
    let (problem, diagnostics) = read_problem(&SourceFile::new("p.pddl", text), &domain);
    let elapsed_s = start.elapsed().as_secs_f64();
    let facts = problem.map_or(0, |problem| problem.fluents.len());
    println!(
        "{facts} values, {megabytes} MB, {elapsed_s:.2} s, {} diagnostics",
        diagnostics.len()
    );
}
