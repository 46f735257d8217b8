"""Sizes without recorded optima, beside longer runs."""

from pathlib import Path

import pytest

from scenarios.benchmarks.planner import held_out
from scenarios.benchmarks.planner.contest import Run
from scenarios.benchmarks.planner.instances import Instance


def test_a_row_compares_the_mean_of_the_seeds_with_the_best_of_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run_own(instance: Instance, limit_s: float, seed: int = 0) -> Run:
        short = limit_s == held_out.LIMIT_S
        plans = ((0.25 * seed, 130.0), (2.0, 100.0 + 10 * seed)) if short else ((1.0, 100.0),)
        return Run(instance.name, instance.family, "marsupial", "solved", plans, 40.0 + seed)

    monkeypatch.setattr(held_out, "run_own", run_own)
    measured = held_out.measure(held_out.SIZES[0], 1, (1, 2), 40.0, tmp_path)
    assert measured.gaps == pytest.approx([0.1, 0.2])
    cells = held_out.cells(measured)
    assert cells[:7] == ["0.500", "130", "115", "100", "47", "15.0 %", "20.0 %"]


def test_a_proved_optimum_needs_no_longer_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run_own(instance: Instance, limit_s: float, seed: int = 0) -> Run:
        assert limit_s == held_out.LIMIT_S
        outcome = "solved_optimally" if seed == 2 else "solved_timed_out"
        return Run(instance.name, instance.family, "marsupial", outcome, ((0.5, 100.0),), 100.0)

    monkeypatch.setattr(held_out, "run_own", run_own)
    measured = held_out.measure(held_out.SIZES[0], 1, (1, 2), 40.0, tmp_path)
    assert held_out.cells(measured)[3] == "100 (optimal)"


def test_the_verdict_names_what_is_missed_in_the_mean() -> None:
    said = held_out.verdict(["floor, problem 2"], [0.0, 0.02, 0.1, 0.0])
    assert "in the mean: floor, problem 2." in said
    assert "3 of 4 runs; mean 3.0 %" in said


def test_the_value_at_a_time_is_the_last_one_by_then() -> None:
    run = Run("a", "disaster", "marsupial", "solved", ((0.5, 9.0), (2.0, 7.0)))
    assert [held_out.at(run, when_s) for when_s in (0.1, 0.5, 3.0)] == [None, 9.0, 7.0]
