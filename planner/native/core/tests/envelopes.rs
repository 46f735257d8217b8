//! Actions that exist for what happens while they run, in the list-schedule space.

mod support;

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use planner_core::attachment::NoAttachments;
use planner_core::grounding::{GroundingLimits, ground};
use planner_core::schedule::{Limits, Optimiser};
use proptest::prelude::*;
use support::{check, read};

/// Fuses are mended by the light of matches, short and long ones; fine ones under a lens, which is
/// focused by the light of one match and has to be held by a second hand.
const CELLAR: &str = "(define (domain cellar)
 (:requirements :typing :durative-actions)
 (:types match fuse - object short long - match quick slow fine - fuse)
 (:predicates (unused ?m - match) (light ?m - match) (hand) (second-hand) (focus) (mended ?f - fuse))
 (:durative-action strike-short :parameters (?m - short) :duration (= ?duration 5)
  :condition (at start (unused ?m))
  :effect (and (at start (not (unused ?m))) (at start (light ?m)) (at end (not (light ?m)))))
 (:durative-action strike-long :parameters (?m - long) :duration (= ?duration 9)
  :condition (at start (unused ?m))
  :effect (and (at start (not (unused ?m))) (at start (light ?m)) (at end (not (light ?m)))))
 (:durative-action hold-lens :parameters (?m - match) :duration (= ?duration 3)
  :condition (and (at start (second-hand)) (over all (light ?m)))
  :effect (and (at start (not (second-hand))) (at end (second-hand))
   (at start (focus)) (at end (not (focus)))))
 (:durative-action mend-quick :parameters (?f - quick ?m - match) :duration (= ?duration 2)
  :condition (and (at start (hand)) (over all (light ?m)))
  :effect (and (at start (not (hand))) (at end (hand)) (at end (mended ?f))))
 (:durative-action mend-slow :parameters (?f - slow ?m - match) :duration (= ?duration 7)
  :condition (and (at start (hand)) (over all (light ?m)))
  :effect (and (at start (not (hand))) (at end (hand)) (at end (mended ?f))))
 (:durative-action mend-fine :parameters (?f - fine) :duration (= ?duration 1)
  :condition (and (at start (hand)) (over all (focus)))
  :effect (and (at start (not (hand))) (at end (hand)) (at end (mended ?f)))))";

/// Fuses and matches by kind.
fn cellar(quick: usize, slow: usize, fine: usize, short: usize, long: usize) -> String {
    let mut text = String::from("(define (problem p) (:domain cellar) (:objects");
    let kinds = [
        ("q", quick, "quick"),
        ("s", slow, "slow"),
        ("f", fine, "fine"),
    ];
    let matches = [("a", short, "short"), ("b", long, "long")];
    for (name, count, kind) in kinds.iter().chain(&matches) {
        for index in 0..*count {
            let _ = write!(text, " {name}{index} - {kind}");
        }
    }
    text += ") (:init (hand) (second-hand)";
    for (name, count, _) in matches {
        for index in 0..count {
            let _ = write!(text, " (unused {name}{index})");
        }
    }
    text += ") (:goal (and";
    for (name, count, _) in kinds {
        for index in 0..count {
            let _ = write!(text, " (mended {name}{index})");
        }
    }
    text + ")))"
}

/// The makespans of the plans that a number of lists gives, each plan checked.
fn makespans(problem: &str, seed: u64, lists: u64) -> Vec<f64> {
    let (domain, problem) = read(CELLAR, problem);
    let limits = GroundingLimits::default();
    let task = ground(&domain, &problem, &NoAttachments, &limits).expect("grounds");
    let mut optimiser = Optimiser::new(&task, seed, None).expect("supported");
    let limits = Limits {
        deadline: None,
        patience: None,
        cancel: &AtomicBool::new(false),
        nodes: Some(lists),
    };
    let mut makespans = Vec::new();
    optimiser.run(None, &limits, &mut |schedule| {
        check(&domain, &problem, &NoAttachments, &schedule.plan(&task));
        makespans.push(schedule.makespan);
    });
    makespans
}

#[test]
fn the_last_match_burns_out_when_the_last_fuse_is_mended() {
    // Two fuses a match; the third match is struck one second before it is needed.
    for seed in 0..3 {
        let found = makespans(&cellar(6, 0, 0, 3, 0), seed, 60);
        let best = found.last().expect("a plan");
        assert!((best - 12.0).abs() < 0.02, "{found:?}");
    }
}

#[test]
fn what_takes_long_gets_a_long_window() {
    let found = makespans(&cellar(1, 1, 0, 1, 1), 0, 60);
    assert!(
        (found.last().expect("a plan") - 9.0).abs() < 0.02,
        "{found:?}"
    );
    assert!(
        makespans(&cellar(0, 1, 0, 4, 0), 0, 60).is_empty(),
        "five seconds are too short"
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_plan_is_valid_and_not_shorter_than_the_work(
        quick in 0usize..5, slow in 0usize..3, fine in 0usize..4, seed in any::<u64>(),
    ) {
        prop_assume!(quick + slow + fine > 0);
        let found = makespans(&cellar(quick, slow, fine, 2 + quick + fine, 1 + slow), seed, 80);
        let best = found.last().copied();
        prop_assert!(best.is_some(), "no plan");
        let work = (2 * quick + 7 * slow + fine) as f64;
        prop_assert!(best.is_some_and(|best| best >= work - 1e-9), "{found:?} below {work}");
    }
}
