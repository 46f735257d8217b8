"""What a search proves depends on the quality of the values it was given."""

import math
from dataclasses import dataclass

import pytest

import planner
from planner import Outcome
from planner.proofs import QUALITIES, weakest_quality

DOMAIN = """
(define (domain trips)
  (:requirements :typing :durative-actions)
  (:types place)
  (:modules (drive ?s ?g - place cost drive@libtrips.so))
  (:predicates (at ?x - place))
  (:durative-action go
    :parameters (?s ?g - place)
    :duration (= ?duration [drive ?s ?g])
    :condition (at start (at ?s))
    :effect (and (at start (not (at ?s))) (at end (at ?g)))))
"""
PROBLEM = """
(define (problem away) (:domain trips)
  (:objects a b - place) (:init (at a)) (:goal (at b)) (:metric minimize (total-time)))
"""


@dataclass
class Drive:
    """A cost of some quality."""

    duration_s: float
    quality: str

    def __call__(self, *_: str) -> float:
        return self.duration_s


@pytest.mark.parametrize(
    ("quality", "solved", "bound", "unsolved"),
    [
        ("exact", Outcome.SOLVED_OPTIMALLY, 7.0, Outcome.PROVEN_UNSOLVABLE),
        ("lower bound", Outcome.SOLVED, 7.0, Outcome.PROVEN_UNSOLVABLE),
        ("approximate", Outcome.SOLVED, 0.0, Outcome.EXHAUSTED),
    ],
)
def test_what_is_proved(quality: str, solved: Outcome, bound: float, unsolved: Outcome) -> None:
    def solve(duration_s: float) -> planner.Result:
        return planner.solve(DOMAIN, PROBLEM, attachments={"Drive": Drive(duration_s, quality)})

    found = solve(7.0)
    assert found.outcome is solved
    assert found.lower_bound == pytest.approx(bound)
    assert found.plan is not None
    assert found.plan.makespan == pytest.approx(7.0)
    assert solve(math.inf).outcome is unsolved


def test_the_weakest_of_those_that_the_domain_asks_counts() -> None:
    attachments = {name: Drive(1.0, name) for name in QUALITIES}
    assert weakest_quality(attachments, ["exact"]) == "exact"
    assert weakest_quality(attachments, ["Exact", "lower bound"]) == "lower bound"
    assert weakest_quality(attachments, QUALITIES) == "approximate"
    assert weakest_quality({"plain": lambda *_: 1.0}, ["plain"]) == "exact"
    assert weakest_quality(None, []) == "exact"
    with pytest.raises(planner.InputError, match="perfect"):
        weakest_quality({"drive": Drive(1.0, "perfect")}, ["drive"])
