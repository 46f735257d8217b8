"""Lazy refinement: the plan's costs are true ones, and few of the others are computed."""

import math
import time
from collections.abc import Sequence

import planner
from semantic_attachments.lazy import solve_lazily

DOMAIN = """
(define (domain roads)
  (:requirements :typing :durative-actions)
  (:types place)
  (:modules (drive ?s ?g - place cost drive@libroads.so))
  (:predicates (at ?x - place))
  (:durative-action go
    :parameters (?s ?g - place)
    :duration (= ?duration [drive ?s ?g])
    :condition (at start (at ?s))
    :effect (and (at start (not (at ?s))) (at end (at ?g)))))
"""
PROBLEM = """
(define (problem home) (:domain roads)
  (:objects a b c d - place) (:init (at a)) (:goal (at d)) (:metric minimize (total-time)))
"""


class Roads:
    """Roads with bounds half as long; those from a to d and from b to d are blocked or long."""

    def __init__(self, lengths: dict[tuple[str, ...], float]) -> None:
        self.lengths = lengths
        self.computed: list[tuple[str, ...]] = []

    def many(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
        self.computed += calls
        return [self.lengths.get(call, 50.0) for call in calls]

    def lower_bounds(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
        found = [self.lengths.get(call, 50.0) for call in calls]
        return [5.0 if math.isinf(length) else length / 2 for length in found]


def test_a_detour_is_found_when_the_straight_way_turns_out_blocked() -> None:
    roads = Roads({("a", "d"): math.inf, ("a", "b"): 4.0, ("b", "d"): math.inf,
                   ("a", "c"): 6.0, ("c", "d"): 7.0})  # fmt: skip
    found = solve_lazily(DOMAIN, PROBLEM, {"drive": roads}, timeout_s=10.0)
    assert found.exact
    plan = found.result.plan
    assert plan is not None
    assert [step.arguments for step in plan] == [("a", "c"), ("c", "d")]
    assert 13.0 <= plan.makespan < 13.1
    assert planner.validate(DOMAIN, PROBLEM, plan, attachments={"drive": roads})
    assert found.refined < 12
    assert found.rounds >= 3


def test_true_bounds_need_one_round() -> None:
    roads = Roads({("a", "d"): 0.0})
    found = solve_lazily(DOMAIN, PROBLEM, {"drive": roads}, timeout_s=5.0)
    assert (found.exact, found.rounds, found.refined) == (True, 1, 1)


def test_no_plan_under_the_bounds_is_no_plan() -> None:
    class Nowhere(Roads):
        def lower_bounds(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
            return [math.inf for _ in calls]

    found = solve_lazily(DOMAIN, PROBLEM, {"drive": Nowhere({})}, timeout_s=5.0)
    assert found.exact
    assert found.result.plan is None
    assert found.refined == 0


def test_when_time_is_short_the_plan_still_has_true_costs() -> None:
    class Slow(Roads):
        def many(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
            time.sleep(0.3)
            return super().many(calls)

    # Every refined way turns out longer than all others look.
    roads = Slow({("a", "d"): 49.0})
    found = solve_lazily(DOMAIN, PROBLEM, {"drive": roads}, timeout_s=0.4)
    assert found.exact
    assert found.result.plan is not None
    assert found.result.plan.makespan == 49.0
    assert planner.validate(DOMAIN, PROBLEM, found.result.plan, attachments={"drive": roads})
