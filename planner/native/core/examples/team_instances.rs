//! Random problems of two families for measurements, as PDDL:
//! `team_instances disaster|marsupial ROBOTS HELPERS TARGETS EXTRA SEED DOMAIN-FILE PROBLEM-FILE`.
//!
//! disaster: ROBOTS explorers visit TARGETS on a floor of rooms whose doors hold EXTRA blockades
//! that HELPERS clearers can remove. marsupial: HELPERS carriers take ROBOTS rovers to EXTRA
//! meeting points around which most of the TARGETS lie.

use std::collections::BinaryHeap;
use std::error::Error;
use std::fmt::Write as _;

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const DISASTER: &str = "(define (domain floor)
 (:requirements :typing :durative-actions :numeric-fluents)
 (:types robot place - object explorer clearer - robot spot blockade - place)
 (:predicates (at ?r - robot ?x - place) (cleared ?b - blockade) (explored ?s - spot)
  (way ?x ?y - place))
 (:functions (cost ?r - robot ?x ?y - place) (size ?b - blockade))
 (:durative-action go :parameters (?r - robot ?x - spot ?y - place)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (way ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y))))
 (:durative-action pass :parameters (?r - robot ?x - blockade ?y - place)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (cleared ?x)) (at start (way ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y))))
 (:durative-action explore :parameters (?r - explorer ?x - spot ?y - spot)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (way ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y)) (at end (explored ?y))))
 (:durative-action pass-explore :parameters (?r - explorer ?x - blockade ?y - spot)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (cleared ?x)) (at start (way ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y)) (at end (explored ?y))))
 (:durative-action clear :parameters (?r - clearer ?b - blockade)
  :duration (= ?duration (size ?b))
  :condition (and (over all (at ?r ?b)))
  :effect (and (at end (cleared ?b)))))
";

const MARSUPIAL: &str = "(define (domain carrying)
 (:requirements :typing :durative-actions :numeric-fluents)
 (:types robot place - object carrier rover - robot site target - place)
 (:predicates (at ?r - robot ?x - place) (on ?r - rover ?c - carrier) (explored ?t - target)
  (way ?r - robot ?x ?y - place))
 (:functions (cost ?r - robot ?x ?y - place) (docked ?c - carrier) (room ?c - carrier))
 (:durative-action dock :parameters (?r - rover ?c - carrier ?x - site)
  :duration (= ?duration 20)
  :condition (and (at start (at ?r ?x)) (over all (at ?c ?x)) (at start (< (docked ?c) (room ?c))))
  :effect (and (at start (not (at ?r ?x))) (at end (on ?r ?c)) (at start (increase (docked ?c) 1))))
 (:durative-action undock :parameters (?r - rover ?c - carrier ?x - site)
  :duration (= ?duration 10)
  :condition (and (at start (on ?r ?c)) (over all (at ?c ?x)))
  :effect (and (at start (not (on ?r ?c))) (at end (at ?r ?x)) (at end (decrease (docked ?c) 1))))
 (:durative-action go :parameters (?r - robot ?x - place ?y - site)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (way ?r ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y))))
 (:durative-action explore :parameters (?r - robot ?x - place ?y - target)
  :duration (= ?duration (cost ?r ?x ?y))
  :condition (and (at start (at ?r ?x)) (at start (way ?r ?x ?y)))
  :effect (and (at start (not (at ?r ?x))) (at end (at ?r ?y)) (at end (explored ?y)))))
";

fn distance(one: (f64, f64), other: (f64, f64)) -> f64 {
    (one.0 - other.0).hypot(one.1 - other.1)
}

/// A floor of rooms with doors between neighbours; nodes are spots and doors.
fn disaster(
    explorers: usize,
    clearers: usize,
    targets: usize,
    blockades: usize,
    random: &mut ChaCha8Rng,
) -> String {
    let columns = 4 + (targets + blockades) / 8;
    let rows = 3 + blockades / 16;
    let (width, height) = (120.0, 120.0);
    // (position, rooms it touches)
    let mut nodes: Vec<((f64, f64), [usize; 2])> = Vec::new();
    let room = |column: usize, row: usize| row * columns + column;
    let mut doors = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (x, y) = (column as f64 * width, row as f64 * height);
            if column + 1 < columns {
                doors.push((
                    (x + width, y + height * random.random_range(0.2..0.8)),
                    [room(column, row), room(column + 1, row)],
                ));
            }
            if row + 1 < rows {
                doors.push((
                    (x + width * random.random_range(0.2..0.8), y + height),
                    [room(column, row), room(column, row + 1)],
                ));
            }
        }
    }
    doors.shuffle(random);
    let blockades = blockades.min(doors.len());
    let mut names = Vec::new();
    for index in 0..explorers + clearers + targets {
        let (column, row) = (
            random.random_range(0..columns),
            random.random_range(0..rows),
        );
        let place = (
            width * (column as f64 + random.random_range(0.1..0.9)),
            height * (row as f64 + random.random_range(0.1..0.9)),
        );
        nodes.push((place, [room(column, row); 2]));
        names.push(if index < explorers + clearers {
            format!("s{index}")
        } else {
            format!("t{}", index - explorers - clearers)
        });
    }
    let spots = nodes.len();
    for (index, door) in doors.iter().enumerate().take(blockades) {
        nodes.push(*door);
        names.push(format!("b{index}"));
    }
    let places = nodes.len();
    nodes.extend(&doors[blockades..]);
    let mut init = String::new();
    for from in 0..places {
        // Dijkstra through open doors; blockades and spots end a way.
        let mut best = vec![f64::INFINITY; nodes.len()];
        best[from] = 0.0;
        let mut queue = BinaryHeap::from([(std::cmp::Reverse(0u64), from)]);
        while let Some((std::cmp::Reverse(bits), node)) = queue.pop() {
            let so_far = f64::from_bits(bits);
            if so_far > best[node] || (node != from && node < places) {
                continue;
            }
            for next in 0..nodes.len() {
                let shared = nodes[node]
                    .1
                    .iter()
                    .any(|room| nodes[next].1.contains(room));
                let far = so_far + distance(nodes[node].0, nodes[next].0);
                if shared && far < best[next] {
                    best[next] = far;
                    queue.push((std::cmp::Reverse(far.to_bits()), next));
                }
            }
        }
        for to in 0..places {
            if to != from && best[to].is_finite() {
                let _ = writeln!(init, "(way {} {})", names[from], names[to]);
                let cost = 1.0 + best[to].round();
                for robot in 0..explorers {
                    let _ = writeln!(
                        init,
                        "(= (cost e{robot} {} {}) {cost})",
                        names[from], names[to]
                    );
                }
                for robot in 0..clearers {
                    let _ = writeln!(
                        init,
                        "(= (cost c{robot} {} {}) {})",
                        names[from],
                        names[to],
                        2.0 * cost
                    );
                }
            }
        }
    }
    for robot in 0..explorers {
        let _ = writeln!(init, "(at e{robot} s{robot})");
    }
    for robot in 0..clearers {
        let _ = writeln!(init, "(at c{robot} s{})", explorers + robot);
    }
    for name in &names[spots..] {
        let _ = writeln!(
            init,
            "(= (size {name}) {})",
            10 * random.random_range(20..40)
        );
    }
    let list = |letter: char, count: usize| {
        (0..count)
            .map(|index| format!(" {letter}{index}"))
            .collect::<String>()
    };
    let goal: String = (0..targets)
        .map(|index| format!("(explored t{index})"))
        .collect();
    format!(
        "(define (problem p) (:domain floor) (:objects{} - explorer{} - clearer {} - spot {} - blockade)\n(:init {init})\n(:goal (and {goal})))",
        list('e', explorers),
        list('c', clearers),
        names[..spots].join(" "),
        names[spots..].join(" ")
    )
}

fn marsupial(
    rovers: usize,
    carriers: usize,
    targets: usize,
    sites: usize,
    random: &mut ChaCha8Rng,
) -> String {
    let side = 400.0 * (sites as f64).sqrt();
    let mut place = |around: Option<(f64, f64)>| match around {
        None => (
            random.random_range(0.0..side),
            random.random_range(0.0..side),
        ),
        Some((x, y)) => (
            x + random.random_range(-120.0..120.0),
            y + random.random_range(-120.0..120.0),
        ),
    };
    let sites_at: Vec<(f64, f64)> = (0..sites).map(|_| place(None)).collect();
    // One target in five is for carriers; the others lie around a site.
    let targets_at: Vec<(Option<usize>, (f64, f64))> = (0..targets)
        .map(|index| {
            let site = (index % 5 != 4).then_some(index % sites);
            (site, place(site.map(|site| sites_at[site])))
        })
        .collect();
    let mut init = String::new();
    let names: Vec<String> = (0..sites)
        .map(|index| format!("m{index}"))
        .chain((0..targets).map(|index| format!("t{index}")))
        .collect();
    let site_of = |index: usize| {
        if index < sites {
            Some(index)
        } else {
            targets_at[index - sites].0
        }
    };
    let at = |index: usize| {
        if index < sites {
            sites_at[index]
        } else {
            targets_at[index - sites].1
        }
    };
    for one in 0..names.len() {
        for other in 0..names.len() {
            if one == other {
                continue;
            }
            let cost = 1.0 + distance(at(one), at(other)).round();
            let carrier_place =
                |index: usize| index < sites || targets_at[index - sites].0.is_none();
            if carrier_place(one) && carrier_place(other) {
                for carrier in 0..carriers {
                    let _ = writeln!(
                        init,
                        "(way c{carrier} {0} {1}) (= (cost c{carrier} {0} {1}) {cost})",
                        names[one], names[other]
                    );
                }
            }
            if site_of(one).is_some() && site_of(one) == site_of(other) {
                for rover in 0..rovers {
                    let _ = writeln!(
                        init,
                        "(way r{rover} {0} {1}) (= (cost r{rover} {0} {1}) {2})",
                        names[one],
                        names[other],
                        2.0 * cost
                    );
                }
            }
        }
    }
    for carrier in 0..carriers {
        let load = (0..rovers)
            .filter(|rover| rover % carriers == carrier)
            .count();
        let _ = writeln!(
            init,
            "(at c{carrier} m{}) (= (docked c{carrier}) {load}) (= (room c{carrier}) {})",
            carrier % sites,
            load.max(2) + 1
        );
    }
    for rover in 0..rovers {
        let _ = writeln!(init, "(on r{rover} c{})", rover % carriers);
    }
    let list = |letter: char, count: usize| {
        (0..count)
            .map(|index| format!(" {letter}{index}"))
            .collect::<String>()
    };
    let goal: String = (0..targets)
        .map(|index| format!("(explored t{index})"))
        .collect();
    format!(
        "(define (problem p) (:domain carrying) (:objects{} - carrier{} - rover{} - site{} - target)\n(:init {init})\n(:goal (and {goal})))",
        list('c', carriers),
        list('r', rovers),
        list('m', sites),
        list('t', targets)
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [
        _,
        family,
        robots,
        helpers,
        targets,
        extra,
        seed,
        domain_file,
        problem_file,
    ] = arguments.as_slice()
    else {
        return Err("usage: team_instances disaster|marsupial ROBOTS HELPERS TARGETS EXTRA SEED DOMAIN-FILE PROBLEM-FILE".into());
    };
    let mut random = ChaCha8Rng::seed_from_u64(seed.parse()?);
    let (robots, helpers) = (robots.parse()?, helpers.parse()?);
    let (targets, extra) = (targets.parse()?, extra.parse()?);
    let (domain, problem) = match family.as_str() {
        "disaster" => (
            DISASTER,
            disaster(robots, helpers, targets, extra, &mut random),
        ),
        _ => (
            MARSUPIAL,
            marsupial(robots, helpers, targets, extra, &mut random),
        ),
    };
    std::fs::write(domain_file, domain)?;
    std::fs::write(problem_file, problem)?;
    Ok(())
}
