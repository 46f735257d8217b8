"""A joint occupancy map of all robots, from their laser scans.

Moravec and Elfes, "High Resolution Maps from Wide Angle Sonar", ICRA 1985; log odds as in Thrun,
Burgard and Fox, "Probabilistic Robotics" (2005), table 9.1.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from simulator import _core
from simulator.occupancy_grid import OccupancyGrid
from simulator.sensors import Scan


@dataclass(frozen=True, slots=True)
class OccupancyModel:
    """How much a beam says, in log odds."""

    hit: float = 0.85
    """added where a beam ends"""
    miss: float = -0.4
    """added where a beam passes"""
    limit: float = 4.0
    """bounds of a cell, so that the map can change its mind"""


class JointOccupancyMap:
    """One map that every robot's scans go into; nothing is known at first."""

    def __init__(
        self,
        shape: tuple[int, int],
        resolution_m: float,
        origin_m: tuple[float, float],
        model: OccupancyModel | None = None,
    ) -> None:
        model = model or OccupancyModel()
        self.resolution_m = resolution_m
        self.origin_m = origin_m
        self._map = _core.OccupancyMap(
            shape, resolution_m, origin_m, model.hit, model.miss, model.limit
        )

    def insert(self, scan: Scan) -> None:
        """Takes one sweep in, at the pose that it was made from; beams that are NaN are left
        out."""
        self._map.insert(*scan.pose, scan.ranges_m, scan.range_m)

    def copy(self) -> Self:
        """A map of its own that knows the same, as robots that lose touch with others have."""
        one = copy(self)
        one._map = self._map.copy()
        return one

    def merge(self, other: Self) -> None:
        """Takes over whatever the other map is more certain of, as robots do that meet."""
        self._map.merge(other._map)

    def cells(self) -> NDArray[np.int8]:
        """(rows, columns) occupancy in percent, -1 where nothing was ever seen."""
        return self._map.percent()

    def grid(self) -> OccupancyGrid:
        """The map as a grid."""
        return OccupancyGrid(self.cells(), self.resolution_m, self.origin_m)
