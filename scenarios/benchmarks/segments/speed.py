"""How long a decision takes: segmentation and assignment, step by step, in CPU time."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from domains.mission_state import MissionState, RobotState, Target
from scenarios.maps import hospital
from semantic_attachments._core import DistanceTransform
from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap, RobotModel
from service.coordination.exploration.problem import ExplorationProblem
from service.coordination.exploration.segment_assignment import SegmentAssignment
from service.coordination.exploration.strategy import Exploring, problem_of
from service.coordination.exploration.targets import exploration_targets
from service.coordination.segmentation.critical_points import critical_points
from service.coordination.segmentation.graph_reduction import reduced
from service.coordination.segmentation.partition import cuts, partition
from service.coordination.segmentation.segmentation import (
    THESIS,
    SegmentationParameters,
    segment,
    way_to_unknown,
)
from service.coordination.segmentation.voronoi_graph import voronoi_graph
from service.coordination.strategy import Situation
from service.messages.mission import PlanningMessage

T = TypeVar("T")
RESOLUTION_M = 0.1
EXPLORER = RobotModel(type="explorer", radius_m=0.25, speed_m_s=0.5, sensor_range_m=5.0)


def partly_explored() -> NDArray[np.int8]:
    """1000 x 500 cells of a hospital floor, of which three rooms in ten are unknown."""
    plan = hospital.draw(1)
    random = np.random.default_rng(1)
    cells = plan.cells()
    for space in plan.spaces:
        if space.kind == "room" and random.random() < 0.3:
            box = space.interior
            # Seen from the door only: the far half and the walls there are unknown.
            cells[box.y0 + box.height // 2 : box.y1 + 1, box.x0 - 1 : box.x1 + 1] = -1
    return np.ascontiguousarray(np.kron(cells, np.ones((2, 2), np.int8))[:500, :1000])


def best_ms(work: Callable[[], T], repeats: int) -> tuple[T, float]:
    """Result and the least CPU time of several tries [ms]."""
    least = np.inf
    for _ in range(repeats):
        begin_s = time.process_time()
        result = work()
        least = min(least, time.process_time() - begin_s)
    return result, 1e3 * least


def speed_table(*, quick: bool) -> str:
    """Markdown: the steps of a segmentation, whole decisions, and assignments of large teams."""
    repeats = 3 if quick else 15
    cells = partly_explored()
    rows = [("step", "CPU ms"), ("---", "---")]
    rows += [(name, f"{ms:.1f}") for name, ms in _steps(cells, repeats)]
    teams = [("robots", "targets", "costs and decision, CPU ms", "assignment alone, CPU ms")]
    teams.append(("---",) * 4)
    for robots in (8, 100, 300) if quick else (8, 100, 300, 500):
        teams.append(_decision(cells, robots, repeats if robots == 8 else 3))
    return (
        f"Map of {cells.shape[1]} x {cells.shape[0]} cells, {(cells >= 0).mean():.0%} known.\n\n"
        + "\n".join(f"| {' | '.join(row)} |" for row in rows)
        + "\n\n"
        + "\n".join(f"| {' | '.join(row)} |" for row in teams)
    )


def _steps(cells: NDArray[np.int8], repeats: int) -> list[tuple[str, float]]:
    occupied, unknown = cells >= 65, cells < 0
    free = ~occupied & ~unknown
    found: list[tuple[str, float]] = []

    def timed(name: str, work: Callable[[], T]) -> T:
        result, ms = best_ms(work, repeats)
        found.append((name, ms))
        return result

    distances = timed("distance transform", lambda: DistanceTransform(occupied))
    graph = timed(
        "skeleton and graph", lambda: voronoi_graph(free, occupied, RESOLUTION_M, None, distances)
    )
    core = timed("reduction (Algorithm 1)", lambda: reduced(graph))
    ways = timed("way to the unknown", lambda: way_to_unknown(free, unknown))
    critical = timed("critical points", lambda: critical_points(core, ways))
    lines = timed("cuts", lambda: cuts(critical, distances))
    timed("partition", lambda: partition(free, lines))
    timed("segmentation, to the letter", lambda: segment(cells, RESOLUTION_M, THESIS))
    timed("segmentation, as used", lambda: segment(cells, RESOLUTION_M, SegmentationParameters()))
    return found


def _decision(cells: NDArray[np.int8], robots: int, repeats: int) -> tuple[str, str, str, str]:
    """A whole decision of the strategy: segmentation, path lengths, assignment."""
    grid = GridMap(cells, RESOLUTION_M)
    random = np.random.default_rng(2)
    inside = np.flatnonzero(DistanceTransform(cells != 0).distances().ravel() > 4.0)
    starts = np.sort(random.choice(inside, robots, replace=False)).tolist()
    found = exploration_targets(grid, {"explorer": EXPLORER}, {"explorer": starts})
    places = grid.centres_m([target.cell for target in found]).tolist()
    team = tuple(
        RobotState(f"robot {k}", "explorer", (float(x), float(y)))
        for k, (x, y) in enumerate(grid.centres_m(starts).tolist())
    )
    situation = Situation(
        domain="disaster",
        state=MissionState(
            time_s=0.0,
            robots=team,
            targets=tuple(Target(f"t {k}", (x, y)) for k, (x, y) in enumerate(places)),
        ),
        grid=grid,
        models={"explorer": EXPLORER},
        planning=PlanningMessage(),
        trigger="speed",
    )
    strategy = Exploring(SegmentAssignment(), "segments")
    _, whole_ms = best_ms(lambda: strategy.propose(situation, Memory()), repeats)
    problem: ExplorationProblem = problem_of(list(team), situation, Memory())
    _, alone_ms = best_ms(lambda: SegmentAssignment().assign(problem), repeats)
    return str(robots), str(len(found)), f"{whole_ms:.0f}", f"{alone_ms:.0f}"
