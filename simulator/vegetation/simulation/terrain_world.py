"""Ground truth of an outdoor place: material and height of the ground, and what stands on it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.simulation.remission_model import (
    PAVED,
    VEGETATION,
    reflectances,
)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TerrainWorld:
    """A piece of ground in the map frame, its lower left corner at the origin."""

    material: NDArray[np.uint8]
    """`(rows, columns)` of `Material`, row 0 at the bottom."""
    resolution_m: float
    seed: int
    """Draws the reflectances and the undulation of the ground."""
    undulation_m: float = 0.05
    """Amplitude of the ground's height."""
    cylinders: Array = field(default_factory=lambda: np.zeros((0, 5)))
    """`(n, 5)`: trunks, centre x and y, radius, height [m], material."""
    boxes: Array = field(default_factory=lambda: np.zeros((0, 6)))
    """`(n, 6)`: buildings and hedges, x and y from and to, height [m], material."""

    @property
    def size_m(self) -> tuple[float, float]:
        """Width and height."""
        rows, columns = self.material.shape
        return columns * self.resolution_m, rows * self.resolution_m

    def reflectance(self) -> Array:
        """`(materials,)`: of this place."""
        return reflectances(self.seed)

    def cells(self, position_m: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Row and column of positions `(n, 2)`; those outside get the nearest cell."""
        index = np.floor(position_m / self.resolution_m).astype(np.intp)
        rows, columns = self.material.shape
        return np.clip(index[:, 1], 0, rows - 1), np.clip(index[:, 0], 0, columns - 1)

    def material_at(self, position_m: Array) -> NDArray[np.uint8]:
        """Material of the ground `(n,)` at positions `(n, 2)`."""
        return self.material[self.cells(position_m)]

    def ground_m(self, position_m: Array) -> Array:
        """Height of the ground `(n,)` at positions `(n, 2)`: a few long waves."""
        random = np.random.default_rng([self.seed, 1])
        height = np.zeros(len(position_m))
        for _ in range(4):
            heading, length_m = random.uniform(0, 2 * np.pi), random.uniform(15.0, 40.0)
            phase = random.uniform(0, 2 * np.pi)
            along = position_m @ np.array([np.cos(heading), np.sin(heading)])
            height += 0.5 * self.undulation_m * np.sin(2 * np.pi * along / length_m + phase)
        return height

    def vegetation(self) -> NDArray[np.bool_]:
        """`(rows, columns)`: where the ground is vegetation."""
        return np.isin(self.material, [int(kind) for kind in VEGETATION])

    def paved(self) -> NDArray[np.bool_]:
        """`(rows, columns)`: where every robot may drive."""
        return np.isin(self.material, [int(kind) for kind in PAVED])

    def touched(self, position_m: Array, radius_m: float) -> NDArray[np.uint8]:
        """Material `(k,)` of all cells whose centres discs at the positions `(n, 2)` cover.

        Each cell counts once.
        """
        reach = int(np.ceil(radius_m / self.resolution_m))
        offsets = np.mgrid[-reach : reach + 1, -reach : reach + 1].reshape(2, -1).T
        rows, columns = self.cells(position_m)
        covered = np.zeros(self.material.shape, np.bool_)
        for dr, dc in offsets:
            row, column = rows + dr, columns + dc
            centre = np.column_stack([column + 0.5, row + 0.5]) * self.resolution_m
            inside = np.linalg.norm(centre - position_m, axis=1) <= radius_m
            inside &= (row >= 0) & (row < self.material.shape[0])
            inside &= (column >= 0) & (column < self.material.shape[1])
            covered[row[inside], column[inside]] = True
        return self.material[covered]
