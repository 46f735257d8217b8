"""Limits, as far as they are no matter of time."""

from pathlib import Path

import pytest

from planner import read_domain, read_problem
from scenarios.benchmarks.planner import limits
from tests.planner.problems import MATCH_CELLAR


def test_a_search_stops_when_asked() -> None:
    case = next(one for one in limits.chosen(Path("/nowhere")) if "hospital" in one.name)
    problem, attachments = case.read()
    took_ms = limits.stopping_ms(problem, attachments, 0.02)
    assert took_ms is not None
    assert all(value >= 0 for value in took_ms)


def test_a_search_that_does_not_get_to_the_limit_says_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(limits, "NODE_WAIT_S", 0.1)
    problem = read_problem(read_domain(MATCH_CELLAR.domain), MATCH_CELLAR.problem)
    assert limits.nodes_over(problem, {}, 10**12) is None


def test_nodes_are_counted() -> None:
    case = next(one for one in limits.chosen(Path("/nowhere")) if "hospital" in one.name)
    problem, attachments = case.read()
    over = limits.nodes_over(problem, attachments, 200)
    assert over is not None
    assert -1 <= over <= 10
