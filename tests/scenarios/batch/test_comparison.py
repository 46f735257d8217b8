"""Statistics against worked examples and hand-made cells."""

from math import sqrt

import numpy as np
import pytest

from scenarios.batch.comparison import (
    Row,
    compare,
    effect_size,
    holm,
    mean_interval,
    over_placements,
    pairs,
)


def row(strategy: str, seed: int, duration_s: float, **more: object) -> Row:
    common = {"map": "m", "map_seed": seed % 2, "team": "t", "robots": 2, "status": "completed"}
    return {**common, "strategy": strategy, "seed": seed, "duration_s": duration_s, **more}


def test_mean_interval_by_hand() -> None:
    # n = 4, mean 5, standard deviation 2: half width t(0.975, 3) * 2 / sqrt(4) = 3.182.
    values = [5 - sqrt(6), 5 + sqrt(6), 5.0, 5.0]
    interval = mean_interval(values)
    assert interval.mean == pytest.approx(5.0)
    assert interval.high - interval.mean == pytest.approx(3.1824, abs=1e-3)
    assert interval.low + interval.high == pytest.approx(10.0)


def test_mean_interval_of_one_value() -> None:
    interval = mean_interval([3.0])
    assert (interval.low, interval.mean, interval.high) == (3.0, 3.0, 3.0)


def test_holm_worked_example() -> None:
    """Holm (1979): the smallest p times n, then times n - 1, ..., never falling."""
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])


def test_effect_size_is_mean_over_spread() -> None:
    d = effect_size([1.0, 3.0, 2.0, 4.0])
    assert d.mean == pytest.approx(2.5 / np.std([1, 3, 2, 4], ddof=1))
    assert d.low < d.mean < d.high


def test_a_clear_difference_is_significant_and_counted() -> None:
    random = np.random.default_rng(1)
    rows = []
    for seed in range(30):
        base = 300 + 80 * random.random()
        rows += [row("planner", seed, base), row("hungarian", seed, base * 1.25)]
    (found,) = compare(rows, "planner", "hungarian")
    assert found.gain.mean == pytest.approx(0.2)
    assert found.significant
    assert (found.wins, found.losses, found.pairs) == (30, 0, 30)


def test_no_difference_is_not_significant() -> None:
    random = np.random.default_rng(2)
    rows = [
        row(strategy, seed, 300 + 50 * random.random())
        for seed in range(30)
        for strategy in ("planner", "hungarian")
    ]
    (found,) = compare(rows, "planner", "hungarian")
    assert not found.significant
    assert found.gain.low < 0 < found.gain.high


def test_only_completed_pairs_count_and_failures_are_told() -> None:
    rows = [
        row("planner", 1, 10.0),
        row("hungarian", 1, 12.0),
        row("planner", 2, 10.0, status="stuck"),
        row("hungarian", 2, 12.0),
        row("planner", 3, 11.0),
    ]
    assert [(a["seed"], b["seed"]) for a, b in pairs(rows, "planner", "hungarian")] == [(1, 1)]
    (found,) = compare(rows, "planner", "hungarian")
    assert (found.pairs, found.failures, found.reference_failures) == (1, 1, 0)


def test_correction_is_over_the_teams_of_one_map() -> None:
    rows = [
        row(strategy, seed, duration_s + seed * (seed % 3), map=name, team=team)
        for name, teams in (("one", ["a", "b"]), ("two", ["a"]))
        for team in teams
        for seed in range(6)
        for strategy, duration_s in (("planner", 100.0), ("hungarian", 110.0 + seed))
    ]
    found = {(c.map, c.team): c for c in compare(rows, "planner", "hungarian")}
    assert found["two", "a"].holm_p == found["two", "a"].t_test_p
    assert found["one", "a"].holm_p == pytest.approx(2 * found["one", "a"].t_test_p)


def test_placements_are_the_sample_of_the_overall_interval() -> None:
    rows = []
    for seed, saved in ((0, 0.1), (2, 0.1), (1, 0.3), (3, 0.3)):
        rows += [row("planner", seed, 100 * (1 - saved)), row("hungarian", seed, 100.0)]
    overall = over_placements(rows, "m", "planner", "hungarian")
    assert overall.mean == pytest.approx(0.2)
    # Two placements with means 0.1 and 0.3: t(0.975, 1) * 0.1 = 1.27.
    assert overall.high - overall.mean == pytest.approx(1.2706, abs=1e-3)
