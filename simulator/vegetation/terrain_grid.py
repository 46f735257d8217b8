"""The 2D grid that robots plan on: obstacles and terrain classes from the 3D vegetation map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.special import expit, logit

from simulator.vegetation.vegetation_map import VegetationMap

Array = NDArray[np.float64]
TERRAIN_CLASSES = ("paved", "vegetation", "verge")
PAVED, VEGETATION, VERGE = range(3)
UNKNOWN, FREE, OCCUPIED = -1, 0, 100


@dataclass(frozen=True, slots=True)
class TerrainGridParameters:
    """What counts as ground, obstacle and vegetation."""

    step_m: float = 0.25
    """Whatever rises more than this above the lowest voxel around is an obstacle."""
    robot_height_m: float = 1.8
    """What is higher above the ground is passed under."""
    around_m: float = 0.6
    """How far around a column the lowest voxel is looked for."""
    threshold: float = 0.5
    """P(vegetation) from which a cell is vegetation."""
    fill_cells: int = 1
    """Gaps of this many cells between scan lines are filled, with vegetation if it borders them."""


@dataclass(frozen=True)
class TerrainGrid:
    """Cells as in ROS `nav_msgs/OccupancyGrid`, row 0 at the smallest y."""

    cells: NDArray[np.int8]
    """`(rows, columns)`: -1 unknown, 0 free, 100 occupied."""
    vegetation: Array
    """`(rows, columns)`: P(vegetation), NaN where the ground was not classified."""
    resolution_m: float
    origin_m: tuple[float, float]
    threshold: float = 0.5

    def terrain(self, verge_m: float = 0.0) -> NDArray[np.uint8]:
        """`(rows, columns)`: index into `TERRAIN_CLASSES`; unknown ground counts as paved.

        Paved cells with their centre closer than `verge_m` to vegetation's are verge: terrain
        classes bind a robot's centre, so a robot that stays off the verge has no wheel on grass.
        """
        grass = self.is_vegetation()
        terrain = np.where(grass, VEGETATION, PAVED).astype(np.uint8)
        if verge_m > 0 and grass.any():
            away_m = ndimage.distance_transform_edt(~grass) * self.resolution_m
            terrain[~grass & (away_m < verge_m)] = VERGE
        return terrain

    def without_specks(self, least_area_m2: float) -> TerrainGrid:
        """Patches of either class smaller than this, amid the other one, take its class."""
        grass = self.is_vegetation()
        vegetation = self.vegetation.copy()
        ground = self.cells == FREE
        for own, other in ((grass, 0.0), (ground & ~grass, 1.0)):
            pieces, _ = ndimage.label(own)
            small = np.bincount(pieces.ravel()) * self.resolution_m**2 < least_area_m2
            small[0] = False
            vegetation[small[pieces]] = other
        return TerrainGrid(self.cells, vegetation, self.resolution_m, self.origin_m, self.threshold)

    def is_vegetation(self) -> NDArray[np.bool_]:
        """`(rows, columns)`: ground that was classified as vegetation."""
        return np.asarray(self.vegetation >= self.threshold)

    def centres_m(self) -> Array:
        """`(rows, columns, 2)`: positions of the cells' centres in the map frame."""
        row, column = np.indices(self.cells.shape)
        centres = np.stack([column + 0.5, row + 0.5], axis=-1) * self.resolution_m
        return np.asarray(centres + np.array(self.origin_m))

    def coarser(self, factor: int) -> TerrainGrid:
        """Blocks of `factor` x `factor` cells as one: the worst of them decides.

        A block is known if half of its cells are.
        """
        rows, columns = (count // factor * factor for count in self.cells.shape)
        shape = (rows // factor, factor, columns // factor, factor)
        cells = self.cells[:rows, :columns].reshape(shape)
        chance = np.where(np.isnan(self.vegetation), -1.0, self.vegetation)[:rows, :columns]
        worst = chance.reshape(shape).max(axis=(1, 3))
        known = (cells != UNKNOWN).mean(axis=(1, 3)) >= 0.5
        occupied = (cells == OCCUPIED).any(axis=(1, 3))
        merged = np.where(occupied, OCCUPIED, np.where(known, FREE, UNKNOWN)).astype(np.int8)
        vegetation = np.where((worst < 0) | (merged != FREE), np.nan, worst)
        return TerrainGrid(
            merged, vegetation, self.resolution_m * factor, self.origin_m, self.threshold
        )


def terrain_grid(
    vegetation_map: VegetationMap,
    origin_m: tuple[float, float],
    size_m: tuple[float, float],
    parameters: TerrainGridParameters | None = None,
) -> TerrainGrid:
    """Projects a rectangle of the map, its lower left corner at `origin_m`, onto the ground.

    Ground is the voxels up to `step_m` above the lowest surface voxel around; their evidence for
    vegetation adds up. Ground that was never classified stays unknown.
    """
    parameters = parameters or TerrainGridParameters()
    resolution_m = vegetation_map.parameters.resolution_m
    columns, rows = (round(extent / resolution_m) for extent in size_m)
    first = np.round(np.array(origin_m) / resolution_m).astype(np.int64)
    low = (first * resolution_m).tolist()
    high = ((first + np.array([columns, rows])) * resolution_m).tolist()
    centres, evidence, solid = vegetation_map.surface(([*low, -1e3], [*high, 1e3]))
    index = np.floor(centres[:, :2] / resolution_m).astype(np.int64) - first
    inside = ((index >= 0) & (index < [columns, rows])).all(axis=1)
    index, height = index[inside], centres[inside, 2]
    evidence, solid = evidence[inside], solid[inside]
    flat = index[:, 1] * columns + index[:, 0]
    lowest = np.full(rows * columns, np.inf)
    np.minimum.at(lowest, flat, height)
    reach = 2 * round(parameters.around_m / resolution_m) + 1
    ground = ndimage.minimum_filter(lowest.reshape(rows, columns), reach, mode="nearest").ravel()
    above = height - ground[flat]
    level = above < parameters.step_m
    occupied = np.zeros(rows * columns, np.bool_)
    occupied[flat[solid & ~level & (above < parameters.robot_height_m)]] = True
    classified = level & np.isfinite(evidence)
    sums = np.bincount(flat[classified], evidence[classified], rows * columns)
    known = np.bincount(flat[classified], minlength=rows * columns) > 0
    total: Array = np.where(known & ~occupied, sums, np.nan).reshape(rows, columns)
    obstacle = occupied.reshape(rows, columns)
    for _ in range(parameters.fill_cells):
        total = _filled(total, obstacle)
    cells = np.where(obstacle, OCCUPIED, np.where(np.isnan(total), UNKNOWN, FREE)).astype(np.int8)
    chance = expit(total + logit(vegetation_map.parameters.prior))
    return TerrainGrid(
        cells, chance, resolution_m, (float(low[0]), float(low[1])), parameters.threshold
    )


def _filled(evidence: Array, obstacle: NDArray[np.bool_]) -> Array:
    """Cells between known ones get the largest evidence of their neighbours."""
    known = ~np.isnan(evidence)
    window = np.ones((3, 3))
    neighbours = ndimage.convolve((known | obstacle).astype(np.float64), window, mode="constant")
    largest = ndimage.maximum_filter(np.where(known, evidence, -np.inf), 3)
    between = ~known & ~obstacle & (neighbours >= 4) & np.isfinite(largest)
    return np.where(between, largest, evidence)
