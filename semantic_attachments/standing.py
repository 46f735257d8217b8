"""Poses at which a robot can stand: random ones, and those at a place or beside it."""

from itertools import product
from math import ceil, hypot, pi

import numpy as np

from semantic_attachments.grid_map import GridMap, PositionM
from semantic_attachments.outline import Outline
from semantic_attachments.steering import Pose


class Standing:
    """Draws and finds free poses of an outline; with one heading only, that is 0."""

    def __init__(self, outline: Outline, grid: GridMap, headings: int) -> None:
        self._outline = outline
        self._grid = grid
        self._headings = headings
        self._cells = np.flatnonzero(outline.standable)

    def area_m2(self) -> float:
        """Area of the cells that the reference point may be in."""
        return float(self._cells.size) * self._grid.resolution_m**2

    def draw(self, rng: np.random.Generator) -> Pose | None:
        """A random pose, None if the robot does not fit there."""
        cell = int(self._cells[rng.integers(self._cells.size)])
        centre_m = self._grid.centres_m([cell])[0]
        x, y = centre_m + rng.uniform(-0.5, 0.5, 2) * self._grid.resolution_m
        heading = 0.0 if self._headings == 1 else rng.uniform(-pi, pi)
        pose = (float(x), float(y), float(heading))
        return pose if self._outline.is_free(*pose) else None

    def draw_many(self, rng: np.random.Generator, wanted: int) -> list[Pose]:
        """As many random poses as wanted, fewer where there is little room."""
        poses: list[Pose] = []
        for _ in range(4 * wanted if self._cells.size else 0):
            pose = self.draw(rng)
            if pose is not None:
                poses.append(pose)
            if len(poses) == wanted:
                break
        return poses

    def at(self, position_m: PositionM) -> list[Pose]:
        """Free poses at a place, or else at the nearest free spot around it."""
        count = self._headings
        # OMPL's headings are within [-pi, pi).
        headings = [0.0] if count == 1 else [2 * pi * k / count - pi for k in range(count)]
        resolution_m = self._grid.resolution_m
        reach = ceil(1.5 * self._outline.outer_radius_m / resolution_m) + 3
        offsets = sorted(
            (hypot(i, j), i, j) for i, j in product(range(-reach, reach + 1), repeat=2)
        )
        for away, i, j in offsets:
            x, y = position_m[0] + i * resolution_m, position_m[1] + j * resolution_m
            if away <= reach and self._is_beside(position_m, (x, y)):
                poses = [(x, y, h) for h in headings if self._outline.is_free(x, y, h)]
                if poses:
                    return poses
        return []

    def _is_beside(self, place: PositionM, spot: PositionM) -> bool:
        """Whether no wall is between a place and a spot near it."""
        steps = ceil(hypot(*np.subtract(place, spot)) / (self._grid.resolution_m / 2)) + 2
        between = np.linspace(place, spot, steps)
        cells = [self._grid.cell_at((x, y)) for x, y in between[1:].tolist()]
        return all(cell is not None and self._outline.standable.flat[cell] for cell in cells)
