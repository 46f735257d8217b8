"""Limits of a search, and two threads."""

import threading
import time

import pytest

import planner
from planner import solving
from planner.solving import Limits, started
from tests.planner.problems import MATCH_CELLAR


def test_time_that_is_spent_is_taken_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solving.time, "monotonic", lambda: 102.0)
    assert Limits(timeout_s=5.0, seed=3).since(100.0) == Limits(timeout_s=3.0, seed=3)
    assert Limits(timeout_s=1.0).since(100.0).timeout_s == 0.0
    assert Limits(timeout_s=None).since(100.0).timeout_s is None


def test_two_threads_reach_what_one_does() -> None:
    one, two = (
        planner.solve(MATCH_CELLAR.domain, MATCH_CELLAR.problem, timeout_s=2.0, threads=threads)
        for threads in (1, 2)
    )
    assert one.plan is not None
    assert two.plan is not None
    assert two.plan.makespan == pytest.approx(one.plan.makespan, abs=0.01)
    assert two.outcome == one.outcome
    makespans = [plan.makespan for plan in two.plans]
    assert makespans == sorted(makespans, reverse=True)


def test_a_search_that_cannot_tell_its_end_in_time_is_not_waited_for() -> None:
    # The facts alone take longer than a search has after its deadline.
    places = " ".join(f"p{number}" for number in range(600))
    facts = " ".join(f"(road p{one} p{other})" for one in range(600) for other in range(600))
    problem = planner.read_problem(
        """(define (domain roads) (:requirements :typing :durative-actions) (:types place)
             (:predicates (at ?p - place) (road ?a ?b - place))
             (:durative-action go :parameters (?a ?b - place) :duration (= ?duration 1)
               :condition (and (at start (at ?a)) (at start (road ?a ?b)))
               :effect (and (at start (not (at ?a))) (at end (at ?b)))))""",
        f"(define (problem far) (:domain roads) (:objects {places} - place)"
        f" (:init (at p0) {facts}) (:goal (at p599)))",
    )
    running = started(problem, {}, Limits(timeout_s=0.0))
    event = running.next(60.0)
    assert event is not None
    assert event.report is not None
    assert (event.report.outcome, event.report.limit) == ("timed_out", "time")
    # Its own report would say how long it had been at it.
    assert event.report.grounding_s == 0.0
    assert running.next(0.5) is None


def test_an_attachment_under_way_is_waited_for_and_none_is_called_afterwards() -> None:
    problem = planner.read_problem(
        """(define (domain ways) (:requirements :typing :durative-actions) (:types place)
             (:modules (way ?a ?b - place cost way@roads))
             (:predicates (at ?p - place))
             (:durative-action go :parameters (?a ?b - place) :duration (= ?duration [way ?a ?b])
               :condition (at start (at ?a))
               :effect (and (at start (not (at ?a))) (at end (at ?b)))))""",
        "(define (problem far) (:domain ways) (:objects a b c d - place)"
        " (:init (at a)) (:goal (at d)))",
    )
    called, calls, returns = threading.Event(), [], []

    def way(*places: str) -> float:
        calls.append(places)
        called.set()
        time.sleep(0.03)
        returns.append(places)
        return 1.0

    running = started(problem, {"way": way}, Limits(timeout_s=None))
    assert called.wait(60.0)
    running.cancel()
    event = running.next(60.0)
    assert event is not None
    assert event.report is not None
    assert event.report.limit == "cancelled"
    assert calls == returns
    time.sleep(0.3)
    assert calls == returns
    assert running.next(0.0) is None
