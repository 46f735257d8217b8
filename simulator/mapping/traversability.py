"""The plane that a robot moves in, cut out of a 3D map (Wurm, section 5.4; Strand et al., 2008)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.mapping.octree import OctreeMap
from simulator.occupancy_grid import OccupancyGrid


@dataclass(frozen=True, slots=True)
class Passage:
    """What a robot passes over and under."""

    height_m: float = 1.5
    """Height of the robot: what hangs higher is no obstacle."""
    step_m: float = 0.1
    """What is lower than this is driven over."""
    floor_m: float = 0.0
    """Height of the floor in the map frame."""


Columns = tuple[tuple[int, int], tuple[int, int]]
"""Lowest and highest x and y of a part of the plane, in voxels."""


def known_columns(octree: OctreeMap, low_m: float, high_m: float) -> Columns | None:
    """The part of the plane in which a height band is known; None if it is known nowhere."""
    (x, y), maxima = octree.column_maxima(low_m, high_m)
    known = np.isfinite(maxima)
    if not known.any():
        return None
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    return (x + int(columns[0]), y + int(rows[0])), (x + int(columns[-1]), y + int(rows[-1]))


def occupancy_slice(
    octree: OctreeMap, low_m: float, high_m: float, columns: Columns | None = None
) -> OccupancyGrid:
    """Probability of the most likely obstacle in each column of a height band, in percent."""
    columns = columns or known_columns(octree, low_m, high_m) or ((0, 0), (0, 0))
    _, maxima = octree.column_maxima(low_m, high_m, columns)
    known = np.isfinite(maxima)
    percent = np.full(maxima.shape, -1, dtype=np.int8)
    percent[known] = np.rint(100 / (1 + np.exp(-maxima[known]))).astype(np.int8)
    return _grid(percent, octree, columns)


def traversability(
    octree: OctreeMap, passage: Passage, columns: Columns | None = None
) -> OccupancyGrid:
    """Where a robot of some height finds its way: 0 free, 100 an obstacle, -1 not known.

    A column is an obstacle if any voxel between `step_m` and `height_m` above the floor is
    occupied. It is free if there is none and the map knows what is at its foot: the floor itself,
    or the space right above it. Unknown space higher up does not close a column.
    """
    floor_m, foot_m = passage.floor_m, passage.floor_m + passage.step_m
    head_m = passage.floor_m + passage.height_m
    below_m = floor_m - max(passage.step_m, 2 * octree.resolution_m)
    columns = columns or known_columns(octree, below_m, head_m) or ((0, 0), (0, 0))
    _, foot = octree.column_maxima(below_m, foot_m + octree.resolution_m, columns)
    _, body = octree.column_maxima(foot_m, head_m, columns)
    cells = np.full(foot.shape, -1, dtype=np.int8)
    cells[np.isfinite(foot)] = 0
    cells[body >= 0] = 100
    return _grid(cells, octree, columns)


def _grid(cells: NDArray[np.int8], octree: OctreeMap, columns: Columns) -> OccupancyGrid:
    x, y = columns[0]
    return OccupancyGrid(
        cells, octree.resolution_m, (x * octree.resolution_m, y * octree.resolution_m)
    )
