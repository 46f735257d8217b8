"""One sweep of a planar laser range finder, as SLAM sees it: no pose but that of the odometry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.slam.pose import Points, Poses


@dataclass(frozen=True, slots=True, eq=False)
class RangeScan:
    """Ranges at evenly spaced bearings, counter-clockwise, in the sensor's frame."""

    time_s: float
    ranges_m: NDArray[np.float32]
    """(beams,)"""
    first_bearing_rad: float
    bearing_step_rad: float
    range_m: float
    """the sensor's range: beams that long or longer met nothing"""
    odometry: Poses
    """(3,): the sensor's pose in the odometry's frame, which drifts"""

    def bearings_rad(self) -> NDArray[np.float64]:
        """(beams,)"""
        steps = np.arange(len(self.ranges_m))
        return np.asarray(self.first_bearing_rad + self.bearing_step_rad * steps)

    def hits(self) -> NDArray[np.bool_]:
        """(beams,): which beams met something."""
        return np.asarray((self.ranges_m > 0.0) & (self.ranges_m < self.range_m))

    def points(self, spacing_m: float = 0.0) -> Points:
        """(n, 2): where beams ended, in the sensor's frame.

        With a spacing, points are thinned to one a square of that width, so that near walls do not
        outvote far ones.
        """
        hit = self.hits()
        bearings, ranges = self.bearings_rad()[hit], self.ranges_m[hit].astype(np.float64)
        points = np.stack([ranges * np.cos(bearings), ranges * np.sin(bearings)], axis=1)
        return thinned(points, spacing_m) if spacing_m > 0.0 else points


def thinned(points_m: Points, spacing_m: float) -> Points:
    """(n, 2): the first point in each square of that width, in the order of the points."""
    if len(points_m) == 0:
        return points_m
    cells = np.floor(points_m / spacing_m).astype(np.int64)
    cells -= cells.min(axis=0)
    numbers = cells[:, 0] * (int(cells[:, 1].max()) + 1) + cells[:, 1]
    _, first = np.unique(numbers, return_index=True)
    return np.asarray(points_m[np.sort(first)])
