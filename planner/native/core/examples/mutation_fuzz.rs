//! Reads, checks, formats and renders mutated files for some seconds, on a stable compiler:
//! `cargo run --release --example mutation_fuzz -- SECONDS SEED`. The coverage-guided target is in
//! `planner/native/fuzz`.

use std::time::{Duration, Instant};

use planner_core::analysis::{check_files, completions, occurrences};
use planner_core::format::format;
use planner_core::pddl::read_domain;
use planner_core::syntax::code::TABLE;
use planner_core::syntax::render::render_all;
use planner_core::syntax::source::SourceFile;
use planner_core::syntax::tree::Tree;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const SEPARATOR: &str = "\n;;; problem\n";
const SNIPPETS: &[&str] = &[
    "(",
    ")",
    "[",
    "]",
    " - ",
    ";",
    "\n",
    "?x",
    "(and ",
    "(at start ",
    "(over all ",
    "(forall (?x) ",
    "(when ",
    "(= ",
    "(either ",
    ":effect ",
    ":action ",
    "(:init ",
    "(:types ",
    "#t",
    "1e999",
    "-1",
    "\u{fffd}",
    "\u{1d54f}",
    "\0",
    "[m ?x]",
    "(not ",
    "(:derived (p) ",
    "@",
    ":duration ",
];

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seconds = arguments
        .next()
        .and_then(|text| text.parse().ok())
        .unwrap_or(10);
    let seed = arguments
        .next()
        .and_then(|text| text.parse().ok())
        .unwrap_or(0);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut pool: Vec<Vec<u8>> = TABLE.iter().map(|entry| entry.example.into()).collect();
    pool.push(include_bytes!("../tests/files/everything.pddl").to_vec());
    let end = Instant::now() + Duration::from_secs(seconds);
    let (mut count, mut slowest) = (0_u64, Duration::ZERO);
    while Instant::now() < end {
        let mut bytes = pool[random.random_range(0..pool.len())].clone();
        for _ in 0..random.random_range(1..12) {
            mutate(&mut bytes, &pool, &mut random);
        }
        let start = Instant::now();
        run(&bytes);
        slowest = slowest.max(start.elapsed());
        count += 1;
        // Some descendants stay, so that faults pile up.
        if count.is_multiple_of(64) && bytes.len() < 20_000 {
            let place = random.random_range(0..pool.len());
            if pool.len() < 2_000 {
                pool.push(bytes);
            } else {
                pool[place] = bytes;
            }
        }
    }
    println!("{count} files read, slowest {slowest:?}");
}

fn mutate(bytes: &mut Vec<u8>, pool: &[Vec<u8>], random: &mut ChaCha8Rng) {
    let place = random.random_range(0..=bytes.len());
    let end = (place + random.random_range(0..40)).min(bytes.len());
    match random.random_range(0..5) {
        0 => {
            bytes.drain(place..end);
        }
        1 => {
            let snippet = SNIPPETS[random.random_range(0..SNIPPETS.len())];
            bytes.splice(place..place, snippet.bytes());
        }
        2 => {
            let copied = bytes[place..end].to_vec();
            bytes.splice(place..place, copied);
        }
        3 => {
            let other = &pool[random.random_range(0..pool.len())];
            let from = random.random_range(0..=other.len());
            let to = (from + random.random_range(0..80)).min(other.len());
            bytes.splice(place..place, other[from..to].iter().copied());
        }
        _ => {
            if let Some(byte) = bytes.get_mut(place) {
                *byte = random.random();
            }
        }
    }
}

fn run(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let split = text.find(SEPARATOR);
    let domain = &bytes[..split
        .filter(|_| text.len() == bytes.len())
        .unwrap_or(bytes.len())];
    let problem = &bytes[(domain.len() + SEPARATOR.len()).min(bytes.len())..];
    let domain = SourceFile::from_bytes("d.pddl", domain);
    let problem = SourceFile::from_bytes("p.pddl", problem);
    let found = check_files(&domain, &[&problem], None);
    let _ = render_all(&found[0], &domain, None);
    let _ = render_all(&found[1], &problem, Some(&domain));
    let tree = Tree::new(&domain);
    let (model, _) = read_domain(&domain);
    let _ = occurrences(&tree, model.as_ref(), None);
    let _ = completions(&tree, domain.text().len() as u32 / 2, model.as_ref(), None);
    if let Ok(once) = format(&domain) {
        let twice = format(&SourceFile::new("d.pddl", once.as_str()));
        assert_eq!(twice.as_deref(), Ok(once.as_str()));
    }
}
