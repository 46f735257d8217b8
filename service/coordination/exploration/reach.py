"""Where explorers can go in a partially known map, and how long it takes."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import ceil

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semantic_attachments._core import Region, Traversability
from semantic_attachments.contract import Memory
from semantic_attachments.neighbours import grown
from semantic_attachments.robot_class import GridParameters, RobotClass
from semantic_attachments.world import Blockade, GridMap, RobotModel

_KNOWN = GridParameters()
_OPTIMISTIC = GridParameters(unknown_is_free=True)


def reachable_space(
    grid: GridMap, model: RobotModel, blockades: tuple[Blockade, ...], memory: Memory
) -> "ReachableSpace":
    """The space of a robot model, from the memory if nothing has changed since."""
    key = (model.radius_m, tuple(model.enters))
    kept = memory.get("reachable space", _Spaces)
    if kept is None or kept.grid is not grid or kept.blockades != blockades:
        kept = _Spaces(grid, blockades)
        memory.keep("reachable space", kept)
    if key not in kept.spaces:
        kept.spaces[key] = ReachableSpace(grid, model, blockades)
    return kept.spaces[key]


class ReachableSpace:
    """The known space that one class of robots can move in, clear of what is unknown too."""

    def __init__(
        self, grid: GridMap, model: RobotModel, blockades: tuple[Blockade, ...] = ()
    ) -> None:
        robot_class = RobotClass.of(model, grid, _KNOWN)
        self._map: Traversability = robot_class.traversability(grid, blockades, _KNOWN)
        self.mask: NDArray[np.bool_] = self._map.passable()
        """(height, width) where a robot's centre may be."""
        self._class, self._grid, self._blockades = robot_class, grid, blockades
        self._reach_cells = ceil(model.radius_m / grid.resolution_m) + 2
        self._region = Region(self.mask)
        self._snap_cells = 1.5 * model.radius_m / grid.resolution_m + 3.0
        self._metres_a_cell = grid.resolution_m

    def lengths_m(
        self, robot_cells: Sequence[int], target_cells: Sequence[int]
    ) -> NDArray[np.float64]:
        """(robots, targets) lengths of the shortest ways, infinite where there is none.

        One field of distances for each robot or for each target, whatever there are fewer of.
        """
        lengths = np.full((len(robot_cells), len(target_cells)), np.inf)
        starts = [self.snapped(cell) for cell in robot_cells]
        rows = [row for row, start in enumerate(starts) if start is not None]
        known = [start for start in starts if start is not None]
        if not known or not len(target_cells):
            return lengths
        if len(set(known)) <= len(target_cells):
            fields: dict[int, NDArray[np.float32]] = {}
            for row, start in zip(rows, known, strict=True):
                if start not in fields:
                    field = self._region.geodesic([start], list(target_cells))
                    fields[start] = field.lengths_to(list(target_cells))
                lengths[row] = fields[start]
        else:
            for column, target in enumerate(target_cells):
                lengths[rows, column] = self._region.geodesic([target], known).lengths_to(known)
        return lengths * self._metres_a_cell

    def way(self, robot_cell: int, target_cell: int) -> NDArray[np.int64]:
        """(n,) cells from a robot to a target; empty if there is no way."""
        start = self.snapped(robot_cell)
        if start is None:
            return np.empty(0, dtype=np.int64)
        field = self._region.geodesic([target_cell], [start])
        return self._region.descend(field, start).astype(np.int64)

    @cached_property
    def ahead(self) -> NDArray[np.bool_]:
        """(height, width) known cells where it could be if what is unknown beside were free."""
        optimistic = self._class.traversability(self._grid, self._blockades, _OPTIMISTIC)
        return optimistic.passable() & (self._grid.cells >= 0)

    def before(self, reached: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """(height, width) a part of the space, and the known cells right before it."""
        for _ in range(self._reach_cells):
            reached = reached | (grown(reached) & self.ahead)
        return reached

    def connected_with(self, cells: Sequence[int]) -> NDArray[np.bool_]:
        """(height, width) the part of the space that is connected with one of its cells.

        By edges, as no way leads across a corner.
        """
        labels, _ = ndimage.label(self.mask)
        present = np.unique(labels.ravel()[list(cells)]) if len(cells) else np.empty(0, np.int32)
        kept = np.zeros(int(labels.max()) + 1, dtype=np.bool_)
        kept[present] = True
        kept[0] = False
        return kept.take(labels)

    def snapped(self, cell: int) -> int | None:
        """The nearest cell of the space, if there is one within the reach of a small detour."""
        return self.nearest_in(self.mask, cell)

    def nearest_in(self, mask: NDArray[np.bool_], cell: int) -> int | None:
        """The cell of a mask (height, width) that is nearest to a cell, if one is near."""
        columns = mask.shape[1]
        if mask.ravel()[cell]:
            return cell
        row, column = divmod(cell, columns)
        reach = ceil(self._snap_cells)
        low = (max(row - reach, 0), max(column - reach, 0))
        window = mask[low[0] : row + reach + 1, low[1] : column + reach + 1]
        near = np.argwhere(window) + low
        if not len(near):
            return None
        apart = np.hypot(near[:, 0] - row, near[:, 1] - column)
        best = int(np.argmin(apart))
        if apart[best] > self._snap_cells:
            return None
        return int(near[best, 0] * columns + near[best, 1])


@dataclass
class _Spaces:
    """The spaces of one map, by radius and terrain classes."""

    grid: GridMap
    blockades: tuple[Blockade, ...]
    spaces: dict[tuple[float, tuple[str, ...]], ReachableSpace] = field(default_factory=dict)
