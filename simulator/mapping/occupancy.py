"""A joint occupancy map of all robots, from their laser scans.

Moravec and Elfes, "High Resolution Maps from Wide Angle Sonar", ICRA 1985; log odds as in Thrun,
Burgard and Fox, "Probabilistic Robotics" (2005), table 9.1.
"""

from __future__ import annotations

from dataclasses import dataclass

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
        """Takes one sweep in, at the pose that it was made from."""
        self._map.insert(*scan.pose, scan.ranges_m, scan.range_m)

    def grid(self) -> OccupancyGrid:
        """Occupancy in percent, -1 where nothing was ever seen."""
        log_odds = self._map.log_odds()
        percent = np.rint(100.0 / (1.0 + np.exp(-log_odds))).astype(np.int8)
        cells: NDArray[np.int8] = np.where(log_odds == 0.0, np.int8(-1), percent)
        return OccupancyGrid(cells, self.resolution_m, self.origin_m)
