"""Path costs whose searches are Python alone, to compare with the native ones."""

from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from math import inf, nan, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.legs import Layer
from semantic_attachments.path_costs import PathCosts
from semantic_attachments.world import World

DIAGONAL = sqrt(2)

End = tuple[int, int | None]
"""A cell and the number of the blockade that is open there."""


@dataclass
class PythonField:
    """The shortest-path tree of a source."""

    source: int
    distances: list[float]
    before: list[int]
    nbytes: int = 0

    def distance(self, cell: int) -> float:
        """Distance of a cell [cells]."""
        return self.distances[cell]

    def path_to(self, goal: int) -> NDArray[np.uint32]:
        """(n,) cells from the source to a goal."""
        return path(self.before, {}, goal) if self.distances[goal] < inf else np.empty(0, np.uint32)


class PythonMap:
    """Stands in for the native map: everything but the searches is its."""

    def __init__(self, native: Any) -> None:
        self._native = native
        self._width = native.shape[1]

    def __getattr__(self, name: str) -> Any:
        return getattr(self._native, name)

    def field(self, source: int, opened: Sequence[int] = ()) -> PythonField:
        """Dijkstra's algorithm with a heap."""
        passable = self._native.passable(list(opened)).ravel().tolist()
        distances, before = [inf] * len(passable), [-1] * len(passable)
        distances[source] = 0.0
        grow(passable, self._width, distances, before, [(0.0, source)])
        return PythonField(source, distances, before)

    def legs(
        self, field: PythonField, source: End, goals: Sequence[End], limit_cells: float
    ) -> tuple[list[float], list[bool], list[bool], NDArray[np.uint32], list[int]]:
        """What `Traversability.legs` answers."""
        lengths, from_beside, to_beside = [], [], []
        paths, stops = [np.empty(0, np.uint32)], [0]
        for goal in goals:
            opened = sorted({end[1] for end in (source, goal) if end[1] is not None})
            start = self._native.nearest(source[0], opened, limit_cells)
            end = self._native.nearest(goal[0], opened, limit_cells)
            length, way = inf, np.empty(0, np.uint32)
            if start is not None and end is not None:
                if start[0] != field.source:
                    length = nan
                elif goal[1] in (None, source[1]):
                    length, way = field.distance(end[0]), field.path_to(end[0])
                else:
                    length, way = self.reach(field, end[0], opened)
                length += start[1] + end[1]
            lengths.append(length)
            from_beside.append(start is None or start[0] != source[0])
            to_beside.append(end is None or end[0] != goal[0])
            paths.append(way)
            stops.append(stops[-1] + len(way))
        return lengths, from_beside, to_beside, np.concatenate(paths), stops[1:]

    def reach(
        self, field: PythonField, goal: int, opened: Sequence[int]
    ) -> tuple[float, NDArray[np.uint32]]:
        """The improvement around opened blockades until the goal is settled."""
        passable = self._native.passable(list(opened)).ravel()
        stamps = np.concatenate([self._native.stamp(number) for number in opened]).astype(np.int64)
        width = self._width
        around = np.unique(
            [stamps + up * width + right for up in (-1, 0, 1) for right in (-1, 0, 1)]
        )
        distances, before = Improved(field.distances), Improved(field.before)
        inside = [cell for cell in around.tolist() if 0 <= cell < passable.size]
        seeds = [(distances[cell], cell) for cell in inside if passable[cell]]
        seeds = [seed for seed in seeds if seed[0] < inf]
        heapify(seeds)
        grow(passable, width, distances, before, seeds, goal=goal)
        if distances[goal] == inf:
            return inf, np.empty(0, np.uint32)
        return distances[goal], path(field.before, before.changes, goal)


class Improved:
    """A list with some entries replaced."""

    def __init__(self, base: list[Any]) -> None:
        self.base = base
        self.changes: dict[int, Any] = {}

    def __getitem__(self, index: int) -> Any:
        return self.changes.get(index, self.base[index])

    def __setitem__(self, index: int, value: Any) -> None:
        self.changes[index] = value


def path(before: list[int], changes: dict[int, int], goal: int) -> NDArray[np.uint32]:
    """(n,) cells that lead to a goal."""
    cells = [goal]
    while (cell := changes.get(cells[-1], before[cells[-1]])) >= 0:
        cells.append(cell)
    return np.array(cells[::-1], dtype=np.uint32)


def grow(
    passable: Any,
    width: int,
    distances: Any,
    before: Any,
    queue: list[tuple[float, int]],
    *,
    goal: int = -1,
) -> None:
    """Settles cells until the queue is empty or the goal is settled; walls surround the map."""
    corners = [(width, 1), (width, -1), (-width, 1), (-width, -1)]
    while queue:
        distance, cell = heappop(queue)
        if distance > distances[cell]:
            continue
        if cell == goal:
            return
        for step in (1, -1, width, -width):
            there = cell + step
            if passable[there] and distance + 1 < distances[there]:
                distances[there] = distance + 1
                before[there] = cell
                heappush(queue, (distance + 1, there))
        for up, right in corners:
            there = cell + up + right
            if (
                passable[there]
                and distance + DIAGONAL < distances[there]
                and passable[cell + up]
                and passable[cell + right]
            ):
                distances[there] = distance + DIAGONAL
                before[there] = cell
                heappush(queue, (distance + DIAGONAL, there))


class PythonPathCosts(PathCosts):
    """Path costs on `PythonMap`."""

    def _layer(self, number: int) -> Layer:
        layer = super()._layer(number)
        stand_in: Any = PythonMap(layer.traversability)
        if not isinstance(layer.traversability, PythonMap):
            layer.traversability = stand_in
        return layer


def python_path_costs(world: World) -> PathCosts:
    """The attachment."""
    return PythonPathCosts(world)
