"""Experiments: grids of buildings, teams, starts and strategies; resumable."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from scenarios.exploration.arms import ARMS
from scenarios.exploration.buildings import Building, generated
from scenarios.exploration.one_run import RunParameters, row_of

Row = dict[str, Any]


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

    def runs(self, done: set[tuple[str, int, int, str]]) -> Iterator[Row]:
        """The rows of all runs that are not done yet, as they end."""
        built: dict[int, Building] = {}
        for start in range(self.starts):
            index = start % len(self.buildings)
            for team in self.teams:
                for arm in self.arms:
                    if (self.name, team, start, arm) in done:
                        continue
                    if index not in built:
                        built[index] = self.buildings[index]()
                    building = built[index]
                    strategy = ARMS[arm](building)
                    row = row_of(
                        building,
                        team,
                        start,
                        strategy,
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
    """Runs what is missing from a CSV file and returns all its rows."""
    rows = read_rows(file)
    done = {key(row) for row in rows}
    total = sum(experiment.size for experiment in experiments)
    count = sum(key in done for experiment in experiments for key in _keys(experiment))
    file.parent.mkdir(parents=True, exist_ok=True)
    for experiment in experiments:
        for row in experiment.runs(done):
            _append(file, row)
            rows.append(row)
            count += 1
            progress(count, total)
    wanted = {key for experiment in experiments for key in _keys(experiment)}
    return [row for row in rows if key(row) in wanted]


def key(row: Row) -> tuple[str, int, int, str]:
    """What tells a run from others."""
    return row["map"], int(row["robots"]), int(row["seed"]), row["strategy"]


def _keys(experiment: Experiment) -> set[tuple[str, int, int, str]]:
    return {
        (experiment.name, team, start, arm)
        for team in experiment.teams
        for start in range(experiment.starts)
        for arm in experiment.arms
    }


def read_rows(file: Path) -> list[Row]:
    """The rows of a file that `run_all` wrote; none if there is no such file."""
    if not file.is_file():
        return []
    with file.open(encoding="utf-8", newline="") as stream:
        return [
            {name: _value(name, text) for name, text in row.items()}
            for row in csv.DictReader(stream)
        ]


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
