"""Robots that see the same map: a class of robots and its native traversability."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from semantic_attachments._core import Traversability
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.world import OCCUPIED_FROM, Blockade, GridMap


@dataclass(frozen=True, slots=True)
class GridParameters:
    """How a grid map reads as travel cost."""

    unknown_is_free: bool = False
    """Whether robots are expected to get through unknown cells (optimistic)."""
    margin_m: float = 0.0
    """Distance kept from obstacles beyond the robot's radius [m]."""
    wall_zone_m: float = 0.0
    """Width of the zone along obstacles in which robots drive slower [m]; 0 for none."""
    wall_slowdown: float = 1.0
    """How many times slower a robot is at an obstacle; falls linearly to 1 over the zone."""
    any_angle: bool = False
    """Whether paths are straight lines between cells that see each other (Theta*) instead of steps
    to neighbours, which are up to 8 % longer."""
    terrain_cost: tuple[tuple[str, float], ...] = ()
    """Factors (at least 1) on the time over terrain classes that are better avoided."""


@dataclass(frozen=True, slots=True)
class RobotClass:
    """What the shape of shortest paths depends on; the robots' speed only scales them."""

    radius_m: float
    enters: tuple[str, ...]
    slowness: tuple[tuple[str, float], ...]
    """Time over each terrain class relative to the fastest, for those that differ from 1."""

    @classmethod
    def of(cls, model: RobotModel, grid: GridMap, parameters: GridParameters) -> "RobotClass":
        """The class of a model on a map."""
        enters = tuple(name for name in grid.terrain_classes if name in model.enters)
        fastest = fastest_m_s(model)
        penalty = dict(parameters.terrain_cost)
        slowness = {
            name: fastest
            / model.terrain_speed_m_s.get(name, model.speed_m_s)
            * penalty.get(name, 1)
            for name in enters
        }
        return cls(
            radius_m=model.radius_m + parameters.margin_m,
            enters=enters,
            slowness=tuple((name, factor) for name, factor in slowness.items() if factor != 1.0),
        )

    def multiplier(self, grid: GridMap, parameters: GridParameters) -> NDArray[np.float32] | None:
        """(height, width) time to cross a cell relative to the fastest; None for 1 everywhere."""
        factors: NDArray[np.float32] | None = None
        if self.slowness:
            by_name = dict(self.slowness)
            by_class = np.array([by_name.get(c, 1.0) for c in grid.terrain_classes], np.float32)
            terrain = np.zeros_like(grid.cells, np.uint8) if grid.terrain is None else grid.terrain
            factors = by_class[terrain]
        if parameters.wall_zone_m > 0 and parameters.wall_slowdown > 1:
            from scipy import ndimage  # imported late: it takes longer than a first plan

            free = grid.cells < OCCUPIED_FROM
            gap_m = ndimage.distance_transform_edt(free) * grid.resolution_m - self.radius_m
            nearness = np.clip(1 - gap_m / parameters.wall_zone_m, 0, 1)
            slowdown = (1 + (parameters.wall_slowdown - 1) * nearness).astype(np.float32)
            factors = slowdown if factors is None else factors * slowdown
        return factors

    def traversability(
        self,
        grid: GridMap,
        blockades: tuple[Blockade, ...],
        parameters: GridParameters,
        extra_radius_m: float = 0.0,
    ) -> Traversability:
        """The map as this class of robots sees it.

        Its centre keeps its radius (and the margin) from the nearest point of every obstacle's
        square, of every unknown cell's and from the outside of the map. Forbidden terrain has no
        such zone: the centre may not enter it, the body may hang over.
        """
        solid = grid.cells >= OCCUPIED_FROM
        if not parameters.unknown_is_free:
            solid |= grid.cells < 0
        forbidden = np.zeros(grid.cells.shape, dtype=bool)
        barred = [name not in self.enters for name in grid.terrain_classes]
        if any(barred):
            terrain = np.zeros_like(grid.cells, np.uint8) if grid.terrain is None else grid.terrain
            forbidden |= np.array(barred).take(terrain)
        return Traversability(
            solid,
            forbidden,
            (self.radius_m + extra_radius_m) / grid.resolution_m,
            self.multiplier(grid, parameters),
            [blockade.cells(grid) for blockade in blockades],
        )


def fastest_m_s(model: RobotModel) -> float:
    """The speed of a robot where it is fastest [m/s]."""
    return max(
        [model.speed_m_s, *(v for k, v in model.terrain_speed_m_s.items() if k in model.enters)]
    )
