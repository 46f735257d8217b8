"""Precision and recall of doorways on complete maps and on maps known in part."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenarios.exploration.arms import ARMS
from scenarios.exploration.buildings import Building, generated
from scenarios.exploration.doorways import Score, score
from scenarios.exploration.one_run import explore
from scenarios.exploration.planner_per_cluster import PlannerPerCluster
from scenarios.maps.floor_plan import Segment
from service.coordination.segmentation.segmentation import CRITERIA, SegmentationParameters
from simulator.kinematic_exploration import Decide, Errand, TeamView

LABELS = Path(__file__).parents[2] / "exploration" / "labels"
"""one TOML file for each labelled map, `NAME_SEED.toml`"""
EVERY = 12
"""one in so many decisions of an exploration is looked at"""


def labelled(file: Path) -> tuple[Building, tuple[Segment, ...]]:
    """A drawn building and the doorways that somebody has marked in it."""
    name, _, seed = file.stem.rpartition("_")
    labels = tomllib.loads(file.read_text(encoding="utf-8"))["doorways_m"]
    doorways = tuple(((a[0], a[1]), (b[0], b[1])) for a, b in labels)
    return generated(name, int(seed)), doorways


def doorway_table(*, quick: bool) -> str:
    """Markdown; `unknown` cuts nothing where all is known, so that its complete maps are blank."""
    files = sorted(LABELS.glob("*.toml"))[: 1 if quick else None]
    lines = [
        "| map | critical points | complete: precision | recall | in part: precision | recall |",
        "|---|---|---|---|---|---|",
    ]
    totals: dict[str, tuple[Score, Score]] = {}
    for file in files:
        building, doorways = labelled(file)
        parts = known_in_part(building)
        for criterion in CRITERIA:
            for least_wall_m in (0.0, 3.5):
                how = SegmentationParameters(criterion=criterion, least_wall_m=least_wall_m)
                name = criterion + (", no furniture" if least_wall_m else "")
                whole = score(building.truth.cells, building.truth.resolution_m, doorways, how)
                partly = sum(
                    (score(cells, building.truth.resolution_m, doorways, how) for cells in parts),
                    Score(),
                )
                lines.append(_line(file.stem, name, whole, partly))
                before = totals.get(name, (Score(), Score()))
                totals[name] = (before[0] + whole, before[1] + partly)
    lines += [_line("all", name, *scores) for name, scores in totals.items()]
    return "\n".join(lines)


def _line(name: str, how: str, whole: Score, partly: Score) -> str:
    def shown(one: Score) -> str:
        precision = f"{one.precision:.2f}" if one.points else "–"
        return f"{precision} of {one.points} | {one.recall:.2f} of {one.doorways}"

    return f"| {name} | {how} | {shown(whole)} | {shown(partly)} |"


def known_in_part(building: Building, robots: int = 3) -> list[NDArray[np.int8]]:
    """Maps as they were at some decisions of an exploration."""
    maps: list[NDArray[np.int8]] = []
    seen = 0

    def watched(at_work: PlannerPerCluster) -> Decide:
        def decide(view: TeamView) -> dict[str, Errand]:
            nonlocal seen
            seen += 1
            if seen % EVERY == 3:
                maps.append(view.grid.cells.copy())
            return dict(at_work(view))

        return decide

    explore(building, robots, 1, ARMS["nearest"](building), watched=watched)
    return maps
