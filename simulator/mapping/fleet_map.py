"""One octree for a fleet: fuses the scans of several robots, gives 2D maps of it.

Plugged into the coordination service by the entry point `marsupial.scan_maps`; neither imports the
other.
"""

import struct
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from simulator.mapping.octree import OctreeMap
from simulator.mapping.traversability import Passage, occupancy_slice, traversability
from simulator.occupancy_grid import OccupancyGrid

HEADER = struct.Struct("<4sHHddddI")
LARGEST = 32767


class Frame(Protocol):
    """Where cells lie in the map frame."""

    @property
    def origin_m(self) -> tuple[float, float]:
        """Lower left corner of the first cell."""

    @property
    def resolution_m(self) -> float:
        """Edge of a cell."""

    @property
    def width(self) -> int:
        """Cells along x."""

    @property
    def height(self) -> int:
        """Cells along y."""


class FleetMap:
    """A 3D map that grows by scans in the map frame.

    Args:
        resolution_m: edge of a voxel [m].
        limit_bytes: what would take more is refused with `MapFullError`.
        contents: a `.ot` file to go on with.
    """

    def __init__(self, resolution_m: float, limit_bytes: int, contents: bytes | None) -> None:
        if contents is None:
            self._octree = OctreeMap(resolution_m, memory_limit_bytes=limit_bytes)
        else:
            self._octree = OctreeMap.from_bytes(contents, memory_limit_bytes=limit_bytes)

    def insert(
        self,
        origin_m: tuple[float, float, float],
        points_m: NDArray[np.float32],
        max_range_m: float | None,
    ) -> None:
        """Adds beams from a place to end points `(n, 3)`.

        Raises:
            MapFullError: the map would take more than its limit; it is as it was.
        """
        self._octree.insert_scan(origin_m, points_m, max_range_m)

    def to_bytes(self, ending: str) -> bytes:
        """The contents of a `.bt` or `.ot` file."""
        return self._octree.to_bytes(ending)

    def passage(
        self, frame: Frame, floor_m: float, step_m: float, height_m: float
    ) -> NDArray[np.int8]:
        """Where a robot of some height finds its way, in the cells of a frame."""
        return resampled(traversability(self._octree, Passage(height_m, step_m, floor_m)), frame)

    def band(self, frame: Frame, low_m: float, high_m: float) -> NDArray[np.int8]:
        """Occupancy in percent of the columns of a height band, in the cells of a frame."""
        return resampled(occupancy_slice(self._octree, low_m, high_m), frame)

    def memory_bytes(self) -> int:
        """Bytes that the map holds."""
        return self._octree.memory_bytes()


def resampled(grid: OccupancyGrid, frame: Frame) -> NDArray[np.int8]:
    """The most occupied of the columns whose centres lie in each cell; -1 where none is known."""
    cells = np.full((frame.height, frame.width), -1, dtype=np.int8)
    size_m = grid.resolution_m
    at = [
        np.floor(
            (grid.origin_m[axis] + (np.arange(count) + 0.5) * size_m - frame.origin_m[axis])
            / frame.resolution_m
        ).astype(np.int64)
        for axis, count in ((1, grid.cells.shape[0]), (0, grid.cells.shape[1]))
    ]
    rows = (at[0] >= 0) & (at[0] < frame.height)
    columns = (at[1] >= 0) & (at[1] < frame.width)
    values = grid.cells[np.ix_(rows, columns)]
    np.maximum.at(cells, (at[0][rows][:, None], at[1][columns][None, :]), values)
    return cells


def scan_message(
    origin_m: tuple[float, float, float], points_m: NDArray[np.floating], scale_m: float = 0.005
) -> bytes:
    """A scan as robots send it: end points `(n, 3)`, map frame, as steps of `scale_m` from the
    sensor, six bytes a beam; twelve where a beam is too long for that.
    """
    beams = np.asarray(points_m, dtype=np.float64) - np.asarray(origin_m)
    steps = np.rint(beams / scale_m)
    if len(steps) and np.abs(steps).max() > LARGEST:
        header = HEADER.pack(b"MSCN", 1, 0, *origin_m, 0.0, len(beams))
        return bytes(header + beams.astype("<f4").tobytes())
    header = HEADER.pack(b"MSCN", 1, 1, *origin_m, scale_m, len(beams))
    return bytes(header + steps.astype("<i2").tobytes())
