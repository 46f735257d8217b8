"""Connected components of where a disc-shaped robot can stand, with blockades closed or open."""

from __future__ import annotations

from collections.abc import Iterable
from math import ceil, hypot

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from scenarios.maps.floor_plan import FREE, OCCUPIED, Point, Segment


def closed(
    cells: NDArray[np.int8], resolution_m: float, segments: Iterable[Segment]
) -> NDArray[np.int8]:
    """The grid `(height, width)` with every segment drawn as occupied cells."""
    grid = cells.copy()
    height, width = grid.shape
    for (x0, y0), (x1, y1) in segments:
        steps = max(1, ceil(hypot(x1 - x0, y1 - y0) / (resolution_m / 4)))
        share = np.linspace(0.0, 1.0, steps + 1)
        columns = np.clip(((x0 + (x1 - x0) * share) / resolution_m).astype(int), 0, width - 1)
        rows = np.clip(((y0 + (y1 - y0) * share) / resolution_m).astype(int), 0, height - 1)
        grid[rows, columns] = OCCUPIED
    return grid


def components(
    cells: NDArray[np.int8], resolution_m: float, clearance_m: float
) -> NDArray[np.int32]:
    """Labels `(height, width)` of where a disc of radius `clearance_m` fits.

    0 where it does not, the components from 1 on, the largest first.
    """
    free = cells == FREE
    clearance = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] * resolution_m
    labels, _ = ndimage.label(clearance > clearance_m, structure=np.ones((3, 3)))
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    rank = np.zeros(len(sizes), np.int32)
    rank[np.argsort(-sizes, kind="stable")] = np.arange(1, len(sizes) + 1)
    rank[0] = 0
    return rank[labels]


def component_at(labels: NDArray[np.int32], resolution_m: float, position_m: Point) -> int:
    """The label of the cell that holds a position [m]."""
    return int(labels[int(position_m[1] / resolution_m), int(position_m[0] / resolution_m)])
