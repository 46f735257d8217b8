"""Draws start positions of a fleet by seed."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, pi
from random import Random

import numpy as np
from numpy.typing import NDArray

from scenarios.maps.floor_plan import Point, Segment
from scenarios.maps.free_space import closed, components

Pose = tuple[float, float, float]


def draw_starts(
    cells: NDArray[np.int8],
    resolution_m: float,
    origin_m: Point,
    *,
    robots: int,
    clearance_m: float,
    seed: str,
    blockades_m: Sequence[Segment] = (),
    spacing_m: float = 1.5,
) -> list[Pose]:
    """Poses drawn uniformly from the largest area that is connected while every blockade is closed.

    Raises:
        ValueError: the area has no room for so many robots at this spacing.
    """
    shifted = [
        tuple((x - origin_m[0], y - origin_m[1]) for x, y in segment) for segment in blockades_m
    ]
    grid = closed(cells, resolution_m, [(a, b) for a, b in shifted])
    rows, columns = np.nonzero(components(grid, resolution_m, clearance_m) == 1)
    if len(rows) == 0:
        raise ValueError(f"the map has no free space for a robot of {clearance_m} m clearance")
    random = Random(seed)
    poses: list[Pose] = []
    for _ in range(1000 * robots):
        if len(poses) == robots:
            break
        k = random.randrange(len(rows))
        x = round(origin_m[0] + (float(columns[k]) + 0.5) * resolution_m, 3)
        y = round(origin_m[1] + (float(rows[k]) + 0.5) * resolution_m, 3)
        if all(hypot(x - a, y - b) >= spacing_m for a, b, _ in poses):
            poses.append((x, y, round(random.uniform(-pi, pi), 3)))
    if len(poses) < robots:
        raise ValueError(f"the map has room for {len(poses)} of {robots} robots")
    return poses
