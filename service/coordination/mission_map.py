"""The map of a mission: what the fleet brought, with what its robots have sensed since.

A patch is a rectangle of cells as in ROS `map_msgs/OccupancyGridUpdate`. Cells of a patch that are
-1 say nothing: they stay as they were.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from semantic_attachments.world import GridMap
from service.coordination.known_map import OCCUPIED_FROM, MapError, inflate
from service.messages.base import Position
from service.messages.report import MapPatch

PATCHES_REMEMBERED = 1000
"""Patches that a report which comes late is compared with."""


@dataclass(frozen=True, slots=True)
class Sensed:
    """A patch that has been read; cells (height, width) from row and column of its lower left."""

    rows: slice
    columns: slice
    cells: NDArray[np.int8]
    terrain: NDArray[np.uint8] | None
    says: NDArray[np.bool_]
    """Which cells it says anything about."""


@dataclass(frozen=True, slots=True)
class MapChange:
    """How much of a map a report changes; (n, 2) rows and columns."""

    closed: NDArray[np.int64]
    """Cells that robots could enter and now perhaps cannot."""
    opened: NDArray[np.int64]
    """Cells that robots could not enter and now perhaps can."""

    @property
    def cells(self) -> int:
        """Cells in which something changes that matters for driving."""
        return len(np.unique(np.concatenate([self.closed, self.opened]), axis=0))


def read_patch(patch: MapPatch, grid: GridMap) -> Sensed:
    """The cells of a patch.

    Raises:
        MapError: with the field that is wrong.
    """
    if patch.row + patch.height > grid.height:
        raise MapError("row", f"the patch ends in row {patch.row + patch.height - 1}; the map has "
                       f"rows 0 to {grid.height - 1}")  # fmt: skip
    if patch.column + patch.width > grid.width:
        raise MapError(
            "column",
            f"the patch ends in column {patch.column + patch.width - 1}; the map has columns 0 to "
            f"{grid.width - 1}",
        )
    shape = (patch.height, patch.width)
    size = patch.height * patch.width
    cells = np.frombuffer(inflate(patch.cells, size, "cells"), dtype=np.int8).reshape(shape)
    if cells.min() < -1 or cells.max() > 100:
        raise MapError("cells", "cells are -1 (not sensed) or 0 to 100")
    terrain = None
    if patch.terrain is not None:
        classes = len(grid.terrain_classes)
        terrain = np.frombuffer(inflate(patch.terrain, size, "terrain"), dtype=np.uint8)
        terrain = terrain.reshape(shape)
        if terrain.max() >= classes:
            raise MapError("terrain", f"names class {int(terrain.max())}; there are {classes}")
    return Sensed(
        slice(patch.row, patch.row + patch.height),
        slice(patch.column, patch.column + patch.width),
        cells,
        terrain,
        cells >= 0,
    )


@dataclass(slots=True)
class MissionMap:
    """The map as known now; `version` grows with every patch that changes it."""

    grid: GridMap
    version: int = 0
    _patched: deque[tuple[int, slice, slice]] = field(default_factory=deque)
    _forgotten: int = -1
    """Reports up to this number may have sent patches that are no longer remembered."""

    def change(self, sequence: int, patches: Sequence[MapPatch]) -> MapChange:
        """What the patches of a report would change."""
        closed, opened = [np.empty((0, 2), np.int64)], [np.empty((0, 2), np.int64)]
        for sensed in self._news(sequence, patches):
            old = self.grid.cells[sensed.rows, sensed.columns]
            was, now = _passable(old), _passable(sensed.cells)
            shuts, opens = was & ~now & sensed.says, ~was & now & sensed.says
            if sensed.terrain is not None:
                other = now & sensed.says & (sensed.terrain != self._terrain(sensed))
                shuts, opens = shuts | (other & was), opens | other
            corner = np.array([sensed.rows.start, sensed.columns.start])
            closed.append(np.argwhere(shuts) + corner)
            opened.append(np.argwhere(opens) + corner)
        return MapChange(np.concatenate(closed), np.concatenate(opened))

    def apply(self, sequence: int, patches: Sequence[MapPatch]) -> None:
        """Takes over what the patches of a report say."""
        news = list(self._news(sequence, patches))
        if not news:
            return
        cells = self.grid.cells.copy()
        terrain = None if self.grid.terrain is None else self.grid.terrain.copy()
        for sensed in news:
            window = (sensed.rows, sensed.columns)
            cells[window][sensed.says] = sensed.cells[sensed.says]
            if sensed.terrain is not None:
                if terrain is None:
                    terrain = np.zeros(cells.shape, np.uint8)
                terrain[window][sensed.says] = sensed.terrain[sensed.says]
            self._remember(sequence, sensed)
        before = self.grid
        same = np.array_equal(cells, before.cells) and (
            terrain is None
            if before.terrain is None
            else terrain is not None and np.array_equal(terrain, before.terrain)
        )
        if not same:
            self.grid = GridMap(
                cells=cells,
                resolution_m=before.resolution_m,
                origin_m=before.origin_m,
                terrain=terrain,
                terrain_classes=before.terrain_classes,
            )
            self.version += 1

    def bars(self, path_m: Sequence[Position], radius_m: float, change: MapChange) -> bool:
        """Whether a robot on this path would come too near a cell that a change closes."""
        if len(path_m) < 2 or not len(change.closed):
            return False
        line = shapely.LineString(path_m)
        west, south, east, north = line.buffer(radius_m).bounds
        size_m = self.grid.resolution_m
        x = self.grid.origin_m[0] + change.closed[:, 1] * size_m
        y = self.grid.origin_m[1] + change.closed[:, 0] * size_m
        near = (x <= east) & (x + size_m >= west) & (y <= north) & (y + size_m >= south)
        x, y = x[near], y[near]
        squares = shapely.box(x, y, x + size_m, y + size_m)
        return bool(shapely.dwithin(squares, line, radius_m).any())

    def _news(self, sequence: int, patches: Sequence[MapPatch]) -> Iterator[Sensed]:
        """The patches, without what later reports have said already."""
        if sequence <= self._forgotten:
            return
        for patch in patches:
            sensed = read_patch(patch, self.grid)
            for number, rows, columns in self._patched:
                if number > sequence:
                    sensed.says[
                        max(rows.start - sensed.rows.start, 0) : max(
                            rows.stop - sensed.rows.start, 0
                        ),
                        max(columns.start - sensed.columns.start, 0) : max(
                            columns.stop - sensed.columns.start, 0
                        ),
                    ] = False
            yield sensed

    def _terrain(self, sensed: Sensed) -> NDArray[np.uint8]:
        if self.grid.terrain is None:
            return np.zeros_like(sensed.cells, dtype=np.uint8)
        return self.grid.terrain[sensed.rows, sensed.columns]

    def _remember(self, sequence: int, sensed: Sensed) -> None:
        self._patched.append((sequence, sensed.rows, sensed.columns))
        if len(self._patched) > PATCHES_REMEMBERED:
            self._forgotten = max(self._forgotten, self._patched.popleft()[0])


def _passable(cells: NDArray[np.int8]) -> NDArray[np.bool_]:
    passable: NDArray[np.bool_] = (cells >= 0) & (cells < OCCUPIED_FROM)
    return passable
