"""Attachments' share of planning time, and what a pure Python attachment costs."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from heapq import heappop, heappush
from math import inf, isfinite, sqrt
from time import process_time
from typing import Any

import planner
from scenarios.benchmarks.attachments.hospital import hospital_problem, hospital_world
from scenarios.benchmarks.attachments.measuring import table
from semantic_attachments import World, bind
from semantic_attachments.robot_class import GridParameters, RobotClass

Call = tuple[str, ...]


@dataclass
class Timed:
    """An attachment and the CPU time spent in it."""

    inner: Any
    spent_s: float = 0.0
    calls: int = 0

    def __call__(self, *arguments: str) -> float:
        return self.many([arguments])[0]

    def many(self, calls: Sequence[Call]) -> Sequence[float]:
        """Asks it in a batch."""
        begun_s = process_time()
        try:
            values: Sequence[float] = self.inner.many(calls)
            return values
        finally:
            self.spent_s += process_time() - begun_s
            self.calls += len(calls)


def run(*, quick: bool) -> str:
    """The disaster instance until the first plan and for a while."""
    world = hospital_world()
    search_s = 2.0 if quick else 30.0
    rows, totals = [], []
    for name in ("native",) if quick else ("native", "pure Python"):
        first, spent_s = measure(name, world, timeout_s=120.0, first_plan_only=True)
        # As long a search for both: what the attachment takes comes on top.
        whole, _ = measure(name, world, timeout_s=search_s + spent_s, first_plan_only=False)
        rows += [[name, "first plan", *first], [name, f"{search_s:g} s of search", *whole]]
        totals.append((first[0], whole[0]))
    columns = [
        "attachment",
        "until",
        "total [s]",
        "attachments [s]",
        "share",
        "calls",
        "makespan [s]",
    ]
    report = table("Disaster instance, 15 targets and 18 blockades", columns, rows)
    if len(totals) < 2:
        return report
    first_ratio, whole_ratio = (python / native for native, python in zip(*totals, strict=True))
    ratios = f"{first_ratio:.2f} to the first plan, {whole_ratio:.2f} for the whole search"
    return f"{report}\n\nPure Python / native, all of planning: {ratios}."


def measure(
    name: str, world: World, *, timeout_s: float, first_plan_only: bool
) -> tuple[list[float], float]:
    """Total and attachment CPU time [s], share, calls, makespan [s]; attachment time again."""
    native = bind(["pathCost", "clearCost"], world)
    timed = {
        "pathCost": Timed(native["pathCost"] if name == "native" else PythonPathCost(world)),
        "clearCost": Timed(native["clearCost"]),
    }
    problem = hospital_problem()
    begun_s = process_time()
    result = planner.solve(
        problem.domain,
        problem,
        attachments=timed,
        timeout_s=timeout_s,
        first_plan_only=first_plan_only,
    )
    total_s = process_time() - begun_s
    spent_s = sum(one.spent_s for one in timed.values())
    makespan = result.plan.makespan if result.plan else inf
    calls = sum(one.calls for one in timed.values())
    return [total_s, spent_s, spent_s / total_s, calls, makespan], spent_s


@dataclass
class PythonPathCost:
    """Path costs in Python alone: Dijkstra with a heap, one search a source and opened
    blockades."""

    world: World
    _fields: dict[tuple[Any, ...], list[float]] = field(default_factory=dict)

    def __call__(self, *arguments: str) -> float:
        return self.many([arguments])[0]

    def many(self, calls: Sequence[Call]) -> list[float]:
        """Travel times [s]."""
        return [self._cost_s(*call) for call in calls]

    def _cost_s(self, robot: str, start: str, goal: str) -> float:
        model, grid = self.world.robots[robot], self.world.grid
        robot_class = RobotClass.of(model, grid, GridParameters())
        places = (self.world.locations[start], self.world.locations[goal])
        opened = tuple(sorted({place.blockade for place in places if place.blockade}))
        cells = [grid.cell_at(place.position_m) for place in places]
        if cells[0] is None or cells[1] is None:
            return inf
        # The way back is as long, so a field from a blockade serves all that drive there.
        source, end = (cells[1], cells[0]) if places[1].blockade else (cells[0], cells[1])
        key = (robot_class, source, opened)
        if key not in self._fields:
            closed = tuple(
                one for name, one in sorted(self.world.blockades.items()) if name not in opened
            )
            passable = robot_class.traversability(grid, closed, GridParameters()).passable()
            self._fields[key] = distances(passable.ravel().tolist(), grid.width, source)
        length = self._fields[key][end]
        return length * grid.resolution_m / model.speed_m_s if isfinite(length) else inf


def distances(passable: list[bool], width: int, source: int) -> list[float]:
    """Distances in cells from a source to all cells."""
    found = [inf] * len(passable)
    found[source] = 0.0
    queue = [(0.0, source)]
    diagonal = sqrt(2)
    corners = [(width, 1), (width, -1), (-width, 1), (-width, -1)]
    while queue:
        distance, cell = heappop(queue)
        if distance > found[cell]:
            continue
        # Walls surround the map, so that no step leaves it.
        for step in (1, -1, width, -width):
            if passable[cell + step] and distance + 1 < found[cell + step]:
                found[cell + step] = distance + 1
                heappush(queue, (distance + 1, cell + step))
        for up, right in corners:
            there = cell + up + right
            if (
                passable[there]
                and distance + diagonal < found[there]
                and passable[cell + up]
                and passable[cell + right]
            ):
                found[there] = distance + diagonal
                heappush(queue, (distance + diagonal, there))
    return found
