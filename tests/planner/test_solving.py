"""Limits of a search, and two threads."""

import pytest

import planner
from planner import solving
from planner.solving import Limits
from tests.planner.problems import MATCH_CELLAR


def test_time_that_is_spent_is_taken_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solving.time, "monotonic", lambda: 102.0)
    assert Limits(timeout_s=5.0, seed=3).since(100.0) == Limits(timeout_s=3.0, seed=3)
    assert Limits(timeout_s=1.0).since(100.0).timeout_s == 0.0
    assert Limits(timeout_s=None).since(100.0).timeout_s is None


def test_two_threads_reach_and_prove_what_one_does() -> None:
    one, two = (
        planner.solve(MATCH_CELLAR.domain, MATCH_CELLAR.problem, threads=threads)
        for threads in (1, 2)
    )
    assert one.plan is not None
    assert two.plan is not None
    assert two.plan.makespan == pytest.approx(one.plan.makespan, abs=0.01)
    assert two.outcome == one.outcome
    makespans = [plan.makespan for plan in two.plans]
    assert makespans == sorted(makespans, reverse=True)
