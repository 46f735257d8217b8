"""Makespans on sizes for which no optimum is recorded, beside the best of longer runs."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from scenarios.benchmarks._markdown import table
from scenarios.benchmarks.planner import building_instances, team_instances
from scenarios.benchmarks.planner.contest import Run, run_own
from scenarios.benchmarks.planner.instances import Instance

ALLOWED = 0.03
"""Part by which the makespan at 10 s may lie above the best of this and the longer runs."""
LONG_S = 40.0
"""CPU time of a longer run [s]."""
REFERENCE_SEEDS = (7,)
"""Of the longer runs."""


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


def run(*, quick: bool) -> str:
    """One row a size and seed: 1 s, 10 s, the best of the longer runs too, the bound; misses."""
    sizes = SIZES[::4] if quick else SIZES
    seeds = (1,) if quick else (1, 2, 3, 4, 5)
    long_s = 10.0 if quick else LONG_S
    rows, missed = [], []
    with tempfile.TemporaryDirectory(prefix="marsupial-held-out-") as folder:
        for size in sizes:
            for seed in seeds:
                cells, gap = row(size, seed, long_s, Path(folder))
                rows.append([size.title, str(seed), *cells])
                if gap > ALLOWED:
                    missed.append(f"{size.title}, seed {seed}")
    columns = [
        "size",
        "seed",
        "first plan [CPU s]",
        "at 1 s",
        "at 10 s",
        f"best, {long_s:g} s too",
        "lower bound",
        "above best",
        "MB",
    ]
    above = f"More than {100 * ALLOWED:g} % above the best of these runs"
    verdict = f"{above}: {'; '.join(missed) or 'none'}."
    return table("Held-out sizes", columns, rows) + "\n\n" + verdict


def row(size: Size, seed: int, long_s: float, folder: Path) -> tuple[list[str], float]:
    """The figures of one problem, and by what part 10 s miss the best of all its runs."""
    instance = Instance(size.family, f"{size.title}, {seed}", folder / "d.pddl", folder / "p.pddl")
    instance.domain.write_text(size.domain, encoding="utf-8")
    instance.problem.write_text(size.problem(seed), encoding="utf-8")
    own = run_own(instance, 10.0)
    runs = [own]
    if own.outcome != "solved_optimally":
        runs += [run_own(instance, long_s, each) for each in REFERENCE_SEEDS]
    if own.best is None:
        return ["-"] * 7, float("inf")
    best = min(run.best for run in runs if run.best is not None)
    bound = max(run.lower_bound for run in runs)
    gap = own.best / best - 1
    first_s = own.plans[0][0] or 0.0
    return [
        f"{first_s:.3f}",
        _shown(at(own, 1.0)),
        _shown(own.best),
        _shown(best)
        + (" (optimal)" if "solved_optimally" in (run.outcome for run in runs) else ""),
        f"{bound:.0f}",
        f"{100 * gap:.1f} %",
        f"{own.peak_mb:.0f}",
    ], gap


def at(run: Run, when_s: float) -> float | None:
    """The best value by then."""
    values = [value for at_s, value in run.plans if at_s is not None and at_s <= when_s]
    return values[-1] if values else None


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.0f}"
