"""Compares two strategies by a measure over paired runs: same map, same team, same seed.

Paired t-test and Wilcoxon's signed-rank test, Holm's correction over the teams of a map, Cohen's d
of the differences with its interval (Hedges and Olkin 1985, large-sample variance), wins and
losses. Where a map entry alternates between several buildings or placements, they are a random
effect: the overall interval is that of the mean over placements.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import sqrt
from typing import Any

import numpy as np
from scipy import stats

Row = dict[str, Any]
LEVEL = 0.95


@dataclass(frozen=True)
class Measure:
    """What runs are compared by."""

    name: str
    unit: str
    of: Callable[[Row], float | None]
    """None for a run that does not have it"""
    less_is_better: bool = True


def _quality(row: Row) -> float | None:
    area_m2, distance_m = row.get("area_m2"), row.get("distance_m")
    return area_m2 / distance_m if area_m2 and distance_m else None


MISSION_TIME = Measure("mission time", "s", lambda row: row["duration_s"])
EXPLORATION_QUALITY = Measure("exploration quality", "m²/m", _quality, less_is_better=False)
"""Area that the team came to know for each metre that it drove (thesis, equation 3.1, printed there
the other way up)."""


@dataclass(frozen=True)
class Interval:
    """A mean and its 95 % confidence interval."""

    mean: float
    low: float
    high: float


@dataclass(frozen=True)
class Comparison:
    """How a strategy compares with a reference."""

    measure: Measure
    map: str
    team: str
    strategy: str
    reference: str
    pairs: int
    failures: int
    """runs of the strategy that did not complete"""
    reference_failures: int
    value: Interval
    reference_value: Interval
    gain: Interval
    """by how much it is better, as a share of the reference's mean; negative if worse"""
    t_test_p: float
    wilcoxon_p: float
    holm_p: float
    """t-test's p, corrected for the number of teams on this map"""
    effect: Interval
    """Cohen's d of the paired differences"""
    wins: int
    losses: int

    @property
    def significant(self) -> bool:
        """Whether the difference survives the correction at 5 %."""
        return self.holm_p < 1 - LEVEL


def mean_interval(values: Sequence[float]) -> Interval:
    """Mean with Student's interval; a single value has an interval of no width."""
    sample = np.asarray(values, float)
    mean = float(sample.mean()) if len(sample) else float("nan")
    if len(sample) < 2 or float(sample.std(ddof=1)) == 0.0:
        return Interval(mean, mean, mean)
    half = float(stats.t.ppf((1 + LEVEL) / 2, len(sample) - 1) * stats.sem(sample))
    return Interval(mean, mean - half, mean + half)


def holm(p_values: Sequence[float]) -> list[float]:
    """Holm's step-down correction (1979), in the order given."""
    order = sorted(range(len(p_values)), key=lambda k: p_values[k])
    corrected = [1.0] * len(p_values)
    running = 0.0
    for rank, k in enumerate(order):
        running = max(running, min(1.0, (len(p_values) - rank) * p_values[k]))
        corrected[k] = running
    return corrected


def effect_size(differences: Sequence[float]) -> Interval:
    """Cohen's d of paired differences with its 95 % interval."""
    sample = np.asarray(differences, float)
    spread = float(sample.std(ddof=1)) if len(sample) > 1 else 0.0
    if spread == 0.0:
        return Interval(0.0, 0.0, 0.0)
    d = float(sample.mean()) / spread
    half = float(stats.norm.ppf((1 + LEVEL) / 2)) * sqrt(
        1 / len(sample) + d * d / (2 * len(sample))
    )
    return Interval(d, d - half, d + half)


def compare(
    rows: Sequence[Row], strategy: str, reference: str, measure: Measure = MISSION_TIME
) -> list[Comparison]:
    """One comparison for each map and team, Holm-corrected over the teams of a map."""
    found: dict[str, list[Comparison]] = defaultdict(list)
    for (map_name, team), cell in cells(rows).items():
        made = _compare_cell((map_name, team), cell, strategy, reference, measure)
        if made is not None:
            found[map_name].append(made)
    result: list[Comparison] = []
    for comparisons in found.values():
        corrected = holm([comparison.t_test_p for comparison in comparisons])
        result += [replace(c, holm_p=p) for c, p in zip(comparisons, corrected, strict=True)]
    return result


def over_placements(rows: Sequence[Row], map_name: str, strategy: str, reference: str) -> Interval:
    """Share of time saved on a map over all teams, with its placements as a random effect."""
    by_placement: dict[Any, list[float]] = defaultdict(list)
    for (name, _), cell in cells(rows).items():
        if name == map_name:
            for own, other in pairs(cell, strategy, reference):
                saved = (other["duration_s"] - own["duration_s"]) / other["duration_s"]
                by_placement[own["map_seed"]].append(saved)
    return mean_interval([float(np.mean(saved)) for saved in by_placement.values()])


def cells(rows: Sequence[Row]) -> dict[tuple[str, str], list[Row]]:
    """Rows by map and team, small teams first."""
    grouped: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for row in sorted(rows, key=lambda row: (row["map"], row.get("robots", 0), row["team"])):
        grouped[row["map"], row["team"]].append(row)
    return grouped


def pairs(cell: Sequence[Row], strategy: str, reference: str) -> list[tuple[Row, Row]]:
    """Completed runs of both strategies with the same seed."""
    done = {(r["strategy"], r["seed"]): r for r in cell if r["status"] == "completed"}
    seeds = sorted({seed for _, seed in done})
    return [
        (done[strategy, seed], done[reference, seed])
        for seed in seeds
        if (strategy, seed) in done and (reference, seed) in done
    ]


def _compare_cell(
    where: tuple[str, str], cell: Sequence[Row], strategy: str, reference: str, measure: Measure
) -> Comparison | None:
    values = [
        (a, b)
        for own, other in pairs(cell, strategy, reference)
        if (a := measure.of(own)) is not None and (b := measure.of(other)) is not None
    ]
    if not values:
        return None
    own, other = np.array(values, float).T
    saved = other - own if measure.less_is_better else own - other
    interval = mean_interval(saved.tolist())
    scale = float(other.mean())
    differ = len(saved) > 1 and float(saved.std()) > 0.0
    t_test_p = float(stats.ttest_rel(own, other).pvalue) if differ else 1.0
    wilcoxon_p = float(stats.wilcoxon(saved).pvalue) if differ else 1.0
    return Comparison(
        measure=measure,
        map=where[0],
        team=where[1],
        strategy=strategy,
        reference=reference,
        pairs=len(values),
        failures=_failures(cell, strategy),
        reference_failures=_failures(cell, reference),
        value=mean_interval(own.tolist()),
        reference_value=mean_interval(other.tolist()),
        gain=Interval(interval.mean / scale, interval.low / scale, interval.high / scale),
        t_test_p=t_test_p,
        wilcoxon_p=wilcoxon_p,
        holm_p=t_test_p,
        effect=effect_size(saved.tolist()),
        wins=int((saved > 0).sum()),
        losses=int((saved < 0).sum()),
    )


def _failures(cell: Sequence[Row], strategy: str) -> int:
    return sum(row["strategy"] == strategy and row["status"] != "completed" for row in cell)
