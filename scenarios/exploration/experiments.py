"""Experiments: grids of buildings, teams, starts and strategies; resumable."""

from __future__ import annotations

import csv
import gc
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from scenarios.exit_codes import CommandError
from scenarios.exploration.arms import ARMS
from scenarios.exploration.buildings import Building, generated
from scenarios.exploration.one_run import RunParameters, row_of

Row = dict[str, Any]
Key = tuple[str, int, int, str]
"""name of the experiment, robots, start, strategy"""


@dataclass(frozen=True)
class Experiment:
    """Every combination of a team, a start and a strategy, paired by the start."""

    name: str
    buildings: tuple[Callable[[], Building], ...]
    """the runs go through them in turn, so that a result is not about one plan only"""
    teams: tuple[int, ...]
    starts: int
    arms: tuple[str, ...]
    parameters: RunParameters = field(default_factory=RunParameters)

    @property
    def size(self) -> int:
        """Number of runs."""
        return len(self.teams) * self.starts * len(self.arms)

    def runs(self, start: int, done: set[Key]) -> Iterator[Row]:
        """The rows of all runs from one start that are not done yet, as they end."""
        building: Building | None = None
        for team in self.teams:
            for arm in self.arms:
                if (self.name, team, start, arm) in done:
                    continue
                building = building or self.buildings[start % len(self.buildings)]()
                row = row_of(
                    building,
                    team,
                    start,
                    ARMS[arm](building),
                    strategy_name=arm,
                    parameters=self.parameters,
                )
                yield {**row, "map": self.name}


def drawn(name: str, seeds: Sequence[int]) -> tuple[Callable[[], Building], ...]:
    """Buildings of a generator."""
    return tuple(lambda seed=seed: generated(name, seed) for seed in seeds)


def run_all(
    experiments: Sequence[Experiment], file: Path, progress: Callable[[int, int], None]
) -> list[Row]:
    """Runs what is missing from a CSV file and returns all its rows.

    All experiments' first starts come first, then their second ones: whenever it is stopped, what
    there is are complete pairs.
    """
    rows = read_rows(file)
    done = {key(row) for row in rows}
    total = sum(experiment.size for experiment in experiments)
    count = sum(key in done for experiment in experiments for key in _keys(experiment))
    file.parent.mkdir(parents=True, exist_ok=True)
    # What is there by now stays: no need to look through it at every collection.
    gc.freeze()
    try:
        for start in range(max((experiment.starts for experiment in experiments), default=0)):
            for experiment in experiments:
                for row in experiment.runs(start, done) if start < experiment.starts else ():
                    _append(file, row)
                    rows.append(row)
                    count += 1
                    progress(count, total)
    finally:
        gc.unfreeze()
    wanted = {key for experiment in experiments for key in _keys(experiment)}
    return [row for row in rows if key(row) in wanted]


def key(row: Row) -> Key:
    """What tells a run from others."""
    return row["map"], int(row["robots"]), int(row["seed"]), row["strategy"]


def _keys(experiment: Experiment) -> set[Key]:
    return {
        (experiment.name, team, start, arm)
        for team in experiment.teams
        for start in range(experiment.starts)
        for arm in experiment.arms
    }


def read_rows(file: Path) -> list[Row]:
    """The rows of a file that `run_all` wrote; none if there is no such file.

    Raises:
        CommandError: a line is none of a run's, for instance cut off by a kill.
    """
    if not file.is_file():
        return []
    rows = []
    with file.open(encoding="utf-8", newline="") as stream:
        reader = csv.DictReader(stream)
        for row in reader:
            try:
                read = {name: _value(name, text) for name, text in row.items()}
                key(read)
            except (KeyError, TypeError, ValueError):
                raise CommandError(
                    f"{file}:{reader.line_num}: this line is no run; remove it, and its run is "
                    "done again"
                ) from None
            rows.append(read)
    return rows


def _value(name: str, text: str) -> Any:
    if name in ("map", "team", "strategy", "status"):
        return text
    return (
        int(text)
        if name in ("map_seed", "robots", "seed", "decisions", "most_targets", "clusters")
        else float(text)
    )


def _append(file: Path, row: Row) -> None:
    begins = not file.is_file()
    with file.open("a", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, fieldnames=list(row))
        if begins:
            writer.writeheader()
        writer.writerow(row)
