"""How much is expected to be seen from an exploration target for the first time.

What lies behind a frontier is counted as if it were free (Burgard, Moors, Stachniss and Schneider,
"Coordinated Multi-Robot Exploration", IEEE Transactions on Robotics 21, 2005, section III-B): the
unknown area that a sensor there would sweep until known walls end its rays.
"""

from collections.abc import Sequence
from math import ceil

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.world import OCCUPIED_FROM, GridMap, PositionM

RAYS = 72


def expected_area_m2(
    grid: GridMap, positions_m: Sequence[PositionM], range_m: Sequence[float]
) -> list[float]:
    """The unknown area in view of each position [m^2], in the map as known.

    Args:
        range_m: how far the sensor that will be there sees, for each position.
    """
    if not positions_m:
        return []
    step_m = grid.resolution_m
    longest_m = max(range_m)
    radii_m = (np.arange(ceil(longest_m / step_m)) + 0.5) * step_m
    angles = np.arange(RAYS) * (2 * np.pi / RAYS)
    places_m = np.asarray(positions_m, dtype=np.float64)
    # (positions, rays, radii)
    x = places_m[:, 0, None, None] + np.cos(angles)[:, None] * radii_m
    y = places_m[:, 1, None, None] + np.sin(angles)[:, None] * radii_m
    columns = np.floor((x - grid.origin_m[0]) / step_m).astype(np.int64)
    rows = np.floor((y - grid.origin_m[1]) / step_m).astype(np.int64)
    inside = (rows >= 0) & (rows < grid.height) & (columns >= 0) & (columns < grid.width)
    cells = np.full(inside.shape, 100, dtype=np.int8)
    cells[inside] = grid.cells[rows[inside], columns[inside]]
    open_so_far = np.logical_and.accumulate(cells < OCCUPIED_FROM, axis=2)
    seen: NDArray[np.bool_] = (cells < 0) & open_so_far
    seen &= radii_m <= np.asarray(range_m)[:, None, None]
    ring_m2 = radii_m * step_m * (2 * np.pi / RAYS)
    return [float(area) for area in (seen * ring_m2).sum(axis=(1, 2))]
