//! Any bytes are read, checked, formatted and rendered without a crash; formatting is idempotent.
//!
//! `cargo +nightly fuzz run --fuzz-dir planner/native/fuzz reader -- -max_total_time=600 -dict=pddl.dict`
//! A line `;;; problem` parts a domain from a problem.

#![no_main]

use libfuzzer_sys::fuzz_target;
use planner_core::analysis::{check_files, completions, occurrences};
use planner_core::format::format;
use planner_core::pddl::read_domain;
use planner_core::syntax::render::render_all;
use planner_core::syntax::source::SourceFile;
use planner_core::syntax::tree::Tree;

const SEPARATOR: &[u8] = b"\n;;; problem\n";

fuzz_target!(|bytes: &[u8]| {
    let split = bytes
        .windows(SEPARATOR.len())
        .position(|window| window == SEPARATOR);
    let (domain, problem) = match split {
        Some(place) => (&bytes[..place], &bytes[place + SEPARATOR.len()..]),
        None => (bytes, &b""[..]),
    };
    let domain = SourceFile::from_bytes("d.pddl", domain);
    let problem = SourceFile::from_bytes("p.pddl", problem);
    let found = check_files(&domain, &[&problem], None);
    let _ = render_all(&found[0], &domain, None);
    let _ = render_all(&found[1], &problem, Some(&domain));

    let tree = Tree::new(&domain);
    let (model, _) = read_domain(&domain);
    let _ = occurrences(&tree, model.as_ref(), None);
    let middle = domain.text().len() as u32 / 2;
    let _ = completions(&tree, middle, model.as_ref(), None);

    if let Ok(once) = format(&domain) {
        let twice = format(&SourceFile::new("d.pddl", once.as_str()));
        assert_eq!(twice.as_deref(), Ok(once.as_str()));
    }
});
