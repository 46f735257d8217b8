"""Makespans on sizes for which no optimum is recorded, beside the best of longer runs."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from scenarios.benchmarks._markdown import table
from scenarios.benchmarks.planner import building_instances, team_instances
from scenarios.benchmarks.planner.contest import Run, run_own
from scenarios.benchmarks.planner.instances import Instance

ALLOWED = 0.03
"""Part by which the makespans at 10 s may lie above the best of all runs, in the mean."""
LIMIT_S = 10.0
"""CPU time of a run [s]."""
SEEDS = (1, 2, 3, 4, 5)
"""Of the runs."""
LONG_S = 40.0
"""CPU time of the longer run [s]."""
LONG_SEED = 7
"""Of the longer run."""


@dataclass(frozen=True, slots=True)
class Size:
    """A size of one family, and what makes its problem from a seed."""

    family: str
    title: str
    domain: str
    problem: Callable[[int], str]


def building_size(building: str, team: tuple[int, int], targets: int, blockades: int) -> Size:
    """A disaster size in drawn buildings."""
    explorers, clearers = team
    return Size(
        "disaster",
        f"{building.replace('_', ' ')}: {explorers} + {clearers} robots, {targets} targets, "
        f"{blockades} blockades",
        team_instances.DISASTER,
        lambda seed: building_instances.disaster(building, team, targets, blockades, seed),
    )


def floor_size(explorers: int, clearers: int, targets: int, blockades: int) -> Size:
    """A disaster size on floors whose doors are mostly blocked."""
    return Size(
        "disaster",
        f"floor: {explorers} + {clearers} robots, {targets} targets, {blockades} blockades",
        team_instances.DISASTER,
        lambda seed: team_instances.disaster(explorers, clearers, targets, blockades, seed),
    )


def marsupial_size(carriers: int, rovers: int, targets: int, sites: int) -> Size:
    """A marsupial size."""
    return Size(
        "marsupial",
        f"{carriers} carriers, {rovers} rovers, {targets} targets, {sites} sites",
        team_instances.MARSUPIAL,
        lambda seed: team_instances.marsupial(carriers, rovers, targets, sites, seed),
    )


SIZES = (
    building_size("random_building", (2, 2), 8, 6),
    building_size("hospital", (3, 2), 15, 18),
    building_size("hospital", (4, 4), 25, 33),
    building_size("power_plant", (3, 2), 13, 58),
    floor_size(2, 2, 8, 6),
    floor_size(3, 2, 15, 18),
    floor_size(4, 4, 25, 33),
    floor_size(3, 2, 13, 58),
    marsupial_size(3, 6, 12, 5),
    marsupial_size(6, 18, 22, 8),
)


@dataclass(frozen=True, slots=True)
class Measured:
    """The runs on one problem, and the longer one unless the optimum was proved without it."""

    runs: tuple[Run, ...]
    longer: tuple[Run, ...]

    @property
    def optimal(self) -> bool:
        """Whether any run proved its plan optimal."""
        return any(run.outcome == "solved_optimally" for run in self.runs + self.longer)

    @property
    def best(self) -> float:
        """The smallest makespan of any run [s]."""
        values = [run.best for run in self.runs + self.longer if run.best is not None]
        return min(values, default=math.inf)

    @property
    def lower_bound(self) -> float:
        """The largest of any run [s]."""
        return max(run.lower_bound for run in self.runs + self.longer)

    @property
    def gaps(self) -> list[float]:
        """By what part the runs miss the best."""
        return [math.inf if run.best is None else run.best / self.best - 1 for run in self.runs]


def run(*, quick: bool) -> str:
    """One row a size and problem: 1 s, 10 s, the best of all runs, the bound; what missed it."""
    sizes = SIZES[::4] if quick else SIZES
    problems = (1,) if quick else (1, 2, 3, 4, 5)
    seeds = SEEDS[:1] if quick else SEEDS
    long_s = LIMIT_S if quick else LONG_S
    rows, missed, gaps = [], [], []
    with tempfile.TemporaryDirectory(prefix="marsupial-held-out-") as folder:
        for size in sizes:
            for problem in problems:
                measured = measure(size, problem, seeds, long_s, Path(folder))
                rows.append([size.title, str(problem), *cells(measured)])
                gaps += measured.gaps
                if fmean(measured.gaps) > ALLOWED:
                    missed.append(f"{size.title}, problem {problem}")
    columns = [
        "size",
        "problem",
        "first plan [CPU s]",
        "at 1 s",
        "at 10 s",
        f"best, {long_s:g} s too",
        "lower bound",
        "above best",
        "worst",
        "MB",
    ]
    return table("Held-out sizes", columns, rows) + "\n\n" + verdict(missed, gaps)


def verdict(missed: list[str], gaps: list[float]) -> str:
    """Which problems are missed in the mean, and how many runs."""
    allowed = f"{100 * ALLOWED:g} %"
    within = sum(gap <= ALLOWED for gap in gaps)
    return (
        f"More than {allowed} above the best in the mean: {'; '.join(missed) or 'none'}. "
        f"Within {allowed}: {within} of {len(gaps)} runs; mean {100 * fmean(gaps):.1f} %."
    )


def measure(
    size: Size, problem: int, seeds: tuple[int, ...], long_s: float, folder: Path
) -> Measured:
    """Runs with each seed, and a longer one with another unless the optimum is proved."""
    instance = Instance(
        size.family, f"{size.title}, {problem}", folder / "d.pddl", folder / "p.pddl"
    )
    instance.domain.write_text(size.domain, encoding="utf-8")
    instance.problem.write_text(size.problem(problem), encoding="utf-8")
    runs = tuple(run_own(instance, LIMIT_S, seed) for seed in seeds)
    measured = Measured(runs, ())
    if measured.optimal:
        return measured
    return Measured(runs, (run_own(instance, long_s, LONG_SEED),))


def cells(measured: Measured) -> list[str]:
    """Means over the runs; the worst of first plans, gaps and memory."""
    return [
        f"{max((run.plans[0][0] or 0.0 for run in measured.runs if run.plans), default=0):.3f}",
        _mean([at(run, 1.0) for run in measured.runs]),
        _mean([run.best for run in measured.runs]),
        f"{measured.best:.0f}" + (" (optimal)" if measured.optimal else ""),
        f"{measured.lower_bound:.0f}",
        f"{100 * fmean(measured.gaps):.1f} %",
        f"{100 * max(measured.gaps):.1f} %",
        f"{max(run.peak_mb for run in measured.runs):.0f}",
    ]


def at(run: Run, when_s: float) -> float | None:
    """The best value by then."""
    values = [value for at_s, value in run.plans if at_s is not None and at_s <= when_s]
    return values[-1] if values else None


def _mean(values: list[float | None]) -> str:
    known = [value for value in values if value is not None]
    return f"{fmean(known):.0f}" if len(known) == len(values) else "-"
