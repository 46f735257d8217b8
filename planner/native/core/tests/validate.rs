//! The validator on plans that must pass and plans that must be rejected: times and intervals.

#[path = "support/validation.rs"]
mod validation;

use planner_core::attachment::NoAttachments;
use planner_core::validate::Options;
use validation::{Case, case};

/// Mending fuses by the light of a match: required concurrency.
fn match_cellar() -> Case {
    case(
        "(define (domain match-cellar)
          (:requirements :typing :durative-actions :numeric-fluents)
          (:types match fuse - object)
          (:predicates (light ?m - match) (unused ?m - match) (mended ?f - fuse) (handfree))
          (:functions (burning) (mending ?f - fuse))
          (:durative-action light_match :parameters (?m - match)
           :duration (= ?duration (burning))
           :condition (and (at start (unused ?m)) (over all (light ?m)))
           :effect (and (at start (not (unused ?m))) (at start (light ?m)) (at end (not (light ?m)))))
          (:durative-action mend_fuse :parameters (?f - fuse ?m - match)
           :duration (= ?duration (mending ?f))
           :condition (and (at start (handfree)) (over all (light ?m)))
           :effect (and (at start (not (handfree))) (at end (mended ?f)) (at end (handfree)))))",
        "(define (problem one) (:domain match-cellar) (:objects m1 m2 - match f1 f2 - fuse)
          (:init (unused m1) (unused m2) (handfree) (= (burning) 8) (= (mending f1) 3) (= (mending f2) 4))
          (:goal (and (mended f1) (mended f2))) (:metric minimize (total-time)))",
    )
}

#[test]
fn a_fuse_is_mended_inside_the_match() {
    let verdict = match_cellar().accepted(
        "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]
         3.002: (mend_fuse f2 m1) [4.000]",
    );
    assert_eq!(verdict.makespan, 8.0);
    assert_eq!(verdict.metric, Some(8.0));
}

#[test]
fn an_invariant_may_begin_where_its_fact_does() {
    // The light is added at the start of the match; the over-all interval is open at its start.
    match_cellar().accepted(
        "0: (light_match m1)[8]
         0: (mend_fuse f1 m1)[3]
         3.001: (mend_fuse f2 m1)[4]",
    );
}

#[test]
fn the_match_goes_out_too_early() {
    let (code, message) = match_cellar().rejected(
        "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]
         5.000: (mend_fuse f2 m1) [4.000]",
    );
    assert_eq!(code, "condition");
    assert_eq!(
        message,
        "happening 5, time 8: (mend_fuse f2 m1) (step 3): its condition over all (light m1) does not hold
  (light m1) is false since 8 (end of (light_match m1))"
    );
}

#[test]
fn the_end_of_an_interval_is_open() {
    // The light goes out exactly when the fuse is done: the over-all condition held before.
    match_cellar().accepted(
        "0.000: (light_match m1) [8.000]
         1.000: (mend_fuse f1 m1) [3.000]
         4.000001: (light_match m2) [8.000]
         8.000001: (mend_fuse f2 m2) [4.000]",
    );
}

#[test]
fn two_actions_at_one_moment_may_not_need_and_delete_the_same() {
    let (code, message) = match_cellar().rejected(
        "0.000: (light_match m1) [8.000]
         0.000: (mend_fuse f1 m1) [3.000]
         3.000: (mend_fuse f2 m1) [4.000]",
    );
    assert_eq!(code, "condition", "{message}");
    assert!(message.contains("(handfree) is false since 0 (start of (mend_fuse f1 m1))"));
    let (code, message) = match_cellar().rejected(
        "0.000: (light_match m1) [8.000]
         0.000: (mend_fuse f1 m1) [3.000]
         0.000: (mend_fuse f2 m1) [4.000]",
    );
    assert_eq!(code, "interference", "{message}");
    assert!(message.contains("(handfree)"), "{message}");
}

#[test]
fn a_goal_that_does_not_hold_is_named_alone() {
    let (code, message) = match_cellar().rejected(
        "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]",
    );
    assert_eq!(code, "goal");
    assert!(
        message.contains("the goal (mended f2) does not hold"),
        "{message}"
    );
    assert!(!message.contains("(and "), "{message}");
}

#[test]
fn durations_hold_within_the_tolerance() {
    let case = match_cellar();
    let plan = |duration: f64| {
        format!(
            "0.000: (light_match m1) [8.000]
             0.001: (mend_fuse f1 m1) [{duration}]
             3.002: (mend_fuse f2 m1) [4.000]"
        )
    };
    assert!(case.verdict(&plan(3.0005)).valid());
    let (code, message) = case.rejected(&plan(3.5));
    assert_eq!(code, "duration");
    assert!(
        message.contains("its duration is 3.5 but must be = 3, the value of (mending f1)"),
        "{message}"
    );
    let strict = Options::strict(0.001);
    assert!(
        !case
            .verdict_with(&plan(3.0005), &strict, &NoAttachments)
            .valid()
    );
}

#[test]
fn separation_is_asked_only_where_wanted() {
    let case = match_cellar();
    let plan = "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]
         3.0012: (mend_fuse f2 m1) [4.000]";
    case.accepted(plan);
    let verdict = case.verdict_with(plan, &Options::strict(0.001), &NoAttachments);
    assert_eq!(verdict.failure.unwrap().reason.code(), "interference");
    let apart = "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]
         3.002: (mend_fuse f2 m1) [4.000]";
    let verdict = case.verdict_with(apart, &Options::strict(0.001), &NoAttachments);
    assert!(verdict.valid(), "{:?}", verdict.failure);
}

#[test]
fn what_else_happens_a_little_earlier_takes_nothing_from_the_separation() {
    let plan = "0.000: (light_match m1) [8.000]
         0.001: (mend_fuse f1 m1) [3.000]
         3.001999998: (light_match m2) [8.000]
         3.002: (mend_fuse f2 m1) [4.000]";
    let verdict = match_cellar().verdict_with(plan, &Options::strict(0.001), &NoAttachments);
    assert!(verdict.valid(), "{:?}", verdict.failure);
}

#[test]
fn a_report_tells_every_check_and_change() {
    let options = Options {
        report: true,
        ..Options::default()
    };
    let verdict = match_cellar().verdict_with(
        "0: (light_match m1)[8]
         0.001: (mend_fuse f1 m1)[3]
         3.002: (mend_fuse f2 m1)[4]",
        &options,
        &NoAttachments,
    );
    let report = verdict.report.join("\n");
    for line in [
        "happening 1, time 0",
        "  start of (light_match m1)",
        "    duration 8 = (burning) holds",
        "    (unused m1) holds",
        "  start of (light_match m1) adds (light m1)",
        "  over all of (mend_fuse f1 m1): (light m1) holds",
        "  end of (light_match m1) deletes (light m1)",
        "the goal holds",
    ] {
        assert!(report.lines().any(|one| one == line), "{line}\n{report}");
    }
}
