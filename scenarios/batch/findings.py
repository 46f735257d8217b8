"""What the runs of a suite say: comparisons, how the missions went, and what has to be zero."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from scenarios.batch.comparison import (
    EXPLORATION_QUALITY,
    MISSION_TIME,
    Comparison,
    Interval,
    Measure,
    Row,
    cells,
    compare,
    mean_interval,
    over_placements,
)
from scenarios.batch.suite import MapEntry, Suite

COUNTS: dict[str, Callable[[Row], int]] = {
    "not completed": lambda row: row["status"] != "completed",
    "stuck": lambda row: row["status"] == "stuck",
    "out of time": lambda row: row["status"] == "out of time",
    "crashed or killed": lambda row: row["status"] in ("crashed", "killed"),
    "wall collisions": lambda row: row.get("wall_collisions", 0),
    "robot contacts": lambda row: row.get("robot_collisions", 0),
    "blockade crossings": lambda row: row.get("blockade_crossings", 0),
}
"""what has to be zero, and how a row tells"""
ONE_STEP = "one-step orders"
"""of the planner's plans in force, those that are orders it falls back to, a step a robot; a plan
that the validator refuses never comes into force"""

CONDITIONS: dict[str, Callable[[Row], float | None]] = {
    "targets sealed [%]": lambda row: _percent(row.get("sealed_fraction")),
    "blockades seen": lambda row: row.get("blockades_seen"),
    "cleared": lambda row: row.get("blockades_cleared"),
    "area known [%]": lambda row: _percent(row.get("known_share")),
    "driven [m]": lambda row: row.get("distance_m"),
    "replans": lambda row: row.get("replans"),
    "CPU a mission [s]": lambda row: row.get("cpu_s"),
}
"""how missions went, as means over the completed ones"""


@dataclass(frozen=True)
class Findings:
    """Everything that the report shows."""

    suite: Suite
    rows: list[Row]
    comparisons: list[Comparison]

    def of(self, entry: MapEntry, measure: Measure) -> list[Comparison]:
        """The comparisons by a measure on a map."""
        return [c for c in self.comparisons if c.map == entry.name and c.measure is measure]

    def strategies(self, entry: MapEntry) -> list[str]:
        """Those that have runs on a map, in the suite's order."""
        here = {row["strategy"] for row in self.rows if row["map"] == entry.name}
        return [name for name in self.suite.all_strategies if name in here]

    def measures(self, entry: MapEntry) -> list[Measure]:
        """Mission time, and what else the runs on a map tell."""
        here = [row for row in self.rows if row["map"] == entry.name]
        explored = any(EXPLORATION_QUALITY.of(row) is not None for row in here)
        return [MISSION_TIME, EXPLORATION_QUALITY] if explored else [MISSION_TIME]

    def values(
        self, entry: MapEntry, measure: Measure, strategies: Sequence[str]
    ) -> dict[str, list[Interval | None]]:
        """By team: the mean of each strategy's completed runs, None where it has none."""
        grouped = {
            team: cell for (name, team), cell in cells(self.rows).items() if name == entry.name
        }
        order = dict.fromkeys(spec.team_name for spec in self.suite.runs())
        return {
            team: [_mean(grouped[team], strategy, measure) for strategy in strategies]
            for team in order
            if team in grouped
        }

    def overall(self) -> Iterator[tuple[MapEntry, str, Interval]]:
        """Time saved over all teams of a map against each strategy; placements are random."""
        subject = self.suite.compared
        for entry in self.suite.maps:
            for other in self.strategies(entry):
                if other != subject:
                    yield entry, other, over_placements(self.rows, entry.name, subject, other)

    def counts(self) -> Iterator[tuple[str, int, list[int | None]]]:
        """For each strategy the number of runs and what has to be zero."""
        for strategy in self.suite.all_strategies:
            own = [row for row in self.rows if row["strategy"] == strategy]
            counts: list[int | None] = [
                sum(int(tell(row)) for row in own) for tell in COUNTS.values()
            ]
            plans = sum(row.get("plans", 0) - row.get("plans_accepted", 0) for row in own)
            yield strategy, len(own), [*counts, plans if self._plans(strategy) else None]

    def conditions(self) -> Iterator[tuple[MapEntry, str, list[float | None]]]:
        """For each map and strategy how the completed missions went."""
        for entry in self.suite.maps:
            for strategy in self.strategies(entry):
                own = [
                    row
                    for row in self.rows
                    if (row["map"], row["strategy"]) == (entry.name, strategy)
                    and row["status"] == "completed"
                ]
                yield entry, strategy, [_mean_of(own, tell) for tell in CONDITIONS.values()]

    def provenance(self) -> str:
        """How many runs, by which versions."""
        done, wanted = len(self.rows), len(self.suite.runs())
        if not self.rows:
            return f"0 of {wanted} runs."
        revisions = ", ".join(sorted({str(row["revision"]) for row in self.rows}))
        first = self.rows[0]
        computed_h = sum(row.get("cpu_s", 0.0) for row in self.rows) / 3600
        return (
            f"{done} of {wanted} runs, {computed_h:.1f} CPU hours; revision {revisions}, marsupial "
            f"{first['version']}, Python {first['python']}, numpy {first['numpy']}, "
            f"pymunk {first['pymunk']}."
        )

    def _plans(self, strategy: str) -> bool:
        variant = self.suite.variants.get(strategy)
        return (strategy if variant is None else variant.strategy) == "planner"


def findings(suite: Suite, rows: Sequence[Row]) -> Findings:
    """Compares the suite's subject with every other strategy."""
    wanted = {spec.key for spec in suite.runs()}
    kept = [row for row in rows if row["key"] in wanted]
    found = Findings(suite, kept, [])
    subject = suite.compared
    for entry in suite.maps:
        here = [row for row in kept if row["map"] == entry.name]
        for measure in found.measures(entry):
            for other in found.strategies(entry):
                if other != subject:
                    found.comparisons.extend(compare(here, subject, other, measure))
    return found


def _mean(cell: Sequence[Row], strategy: str, measure: Measure) -> Interval | None:
    done = [
        value
        for row in cell
        if row["strategy"] == strategy and row["status"] == "completed"
        if (value := measure.of(row)) is not None
    ]
    return mean_interval(done) if done else None


def _mean_of(rows: Sequence[Row], tell: Callable[[Row], float | None]) -> float | None:
    values = [value for row in rows if (value := tell(row)) is not None]
    return float(np.mean(values)) if values else None


def _percent(share: float | None) -> float | None:
    return None if share is None else 100 * share
