"""Known optima over seeds."""

from scenarios.benchmarks.planner.contest import Run
from scenarios.benchmarks.planner.optima import cells


def _run(outcome: str, *plans: tuple[float, float]) -> Run:
    return Run("d01-1x1-t3-b2", "disaster", "marsupial", outcome, plans, peak_mb=40.0)


def test_the_worst_seed_counts() -> None:
    runs = [
        _run("solved_optimally", (0.1, 700.0), (0.2, 690.002)),
        _run("solved_timed_out", (0.3, 690.0)),
    ]
    assert cells(runs) == ["690, 690", "yes", "0.300", "0.300", "1 of 2", "40"]


def test_a_seed_that_misses_is_told() -> None:
    runs = [_run("solved_optimally", (0.1, 690.0)), _run("timed_out")]
    assert cells(runs)[:2] == ["690, -", "no"]
