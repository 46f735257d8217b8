"""Sizes without recorded optima, beside longer runs."""

from pathlib import Path

import pytest

from scenarios.benchmarks.planner import held_out
from scenarios.benchmarks.planner.contest import Run
from scenarios.benchmarks.planner.instances import Instance


def test_a_row_compares_with_the_longer_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run_own(instance: Instance, limit_s: float, seed: int = 0) -> Run:
        plans = ((0.25, 130.0), (2.0, 110.0)) if limit_s == 10 else ((1.0, 100.0),)
        return Run(instance.name, instance.family, "marsupial", "solved", plans, 40.0 + seed)

    monkeypatch.setattr(held_out, "run_own", run_own)
    cells, gap = held_out.row(held_out.SIZES[0], 1, 40.0, tmp_path)
    assert cells[:5] == ["0.250", "130", "110", "100", "47"]
    assert gap == pytest.approx(0.1)


def test_the_value_at_a_time_is_the_last_one_by_then() -> None:
    run = Run("a", "disaster", "marsupial", "solved", ((0.5, 9.0), (2.0, 7.0)))
    assert [held_out.at(run, when_s) for when_s in (0.1, 0.5, 3.0)] == [None, 9.0, 7.0]
