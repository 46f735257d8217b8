"""Problems of tests/must_stay_solved.toml are solved, and at least as well as noted there."""

import tomllib
from pathlib import Path
from typing import Any

import pytest

import planner

PROJECT = Path(__file__).parents[2]
SHARED = PROJECT.parent / "shared" / "data"
LIST = tomllib.loads((PROJECT / "tests" / "must_stay_solved.toml").read_text())["problem"]


@pytest.mark.parametrize("entry", LIST, ids=lambda entry: Path(entry["problem"]).stem)
def test_must_stay_solved(entry: dict[str, Any]) -> None:
    domain, problem = SHARED / entry["domain"], SHARED / entry["problem"]
    if not problem.exists():
        pytest.skip(f"{problem} is not on this machine")
    result = planner.solve(domain, problem, node_limit=entry["nodes"], timeout_s=60.0)
    assert result.plan is not None, result.outcome
    assert result.plan.makespan <= entry["makespan"]
    assert planner.validate(domain, problem, result.plan).valid
    assert result.lower_bound <= result.plan.makespan
