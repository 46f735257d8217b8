"""Simulated drives: a robot with a laser and drifting odometry on a floor, and its true poses."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simulator._core import Floor
from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.pose import Poses, between, compose
from simulator.slam.range_scan import RangeScan

Disc = tuple[float, float, float]
"""x, y, radius [m]"""


@dataclass(frozen=True, slots=True)
class Laser:
    """A planar range finder; the defaults are a SICK LMS 291 at one degree."""

    beams: int = 181
    view_rad: float = math.pi
    range_m: float = 30.0
    noise_m: float = 0.015

    def first_and_step(self) -> tuple[float, float]:
        """First bearing and step [rad]."""
        if self.view_rad >= math.tau - 1e-9:
            return -math.pi, math.tau / self.beams
        return -0.5 * self.view_rad, self.view_rad / (self.beams - 1)


@dataclass(frozen=True, slots=True)
class OdometryNoise:
    """How the odometry of a simulated robot goes wrong."""

    metre_per_metre: float = 0.03
    """standard deviation of a step's length, as a share of it"""
    radian_per_radian: float = 0.04
    radian_per_metre: float = 0.008
    length_bias: float = 0.0
    """systematic share by which steps are measured too long"""


@dataclass(frozen=True, slots=True)
class Drive:
    """Scans of one robot and where it truly was."""

    scans: tuple[RangeScan, ...]
    truth: Poses
    """(n, 3) in the world's frame"""
    steps: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))


class Surveyor:
    """Drives robots over one floor."""

    def __init__(self, grid: OccupancyGrid, discs: Sequence[Disc] = ()) -> None:
        self.floor = Floor(grid.walls(), grid.resolution_m, grid.origin_m)
        self.discs = list(discs)

    def path(
        self, waypoints: Sequence[tuple[float, float]], step_m: float = 0.25, radius_m: float = 0.3
    ) -> Poses:
        """(n, 3): poses along shortest ways between waypoints, turning on the spot at corners.

        Raises:
            ValueError: there is no way to a waypoint.
        """
        corners = [waypoints[0]]
        for start, goal in itertools.pairwise(waypoints):
            route = self.floor.route(start, [goal], radius_m, 0.05, 0.3, [], [])
            if route is None:
                raise ValueError(f"there is no way from {start} to {goal}")
            corners.extend(route[1:])
        return along(corners, step_m)

    def drive(
        self,
        path: Poses,
        laser: Laser,
        noise: OdometryNoise,
        random: np.random.Generator,
        period_s: float = 0.25,
    ) -> Drive:
        """A scan at every pose of the path."""
        odometry = np.zeros(3)
        scans = []
        for place, pose in enumerate(path):
            if place > 0:
                odometry = compose(
                    odometry, _measured(between(path[place - 1], pose), noise, random)
                )
            scans.append(self.scan(pose, laser, odometry, place * period_s, random))
        return Drive(tuple(scans), np.asarray(path))

    def scan(
        self,
        pose: Poses,
        laser: Laser,
        odometry: Poses,
        time_s: float,
        random: np.random.Generator,
    ) -> RangeScan:
        """One sweep."""
        first, step = laser.first_and_step()
        around = round(math.tau / step)
        x, y, heading = (float(value) for value in pose)
        reach = laser.range_m + 1.0
        near = [d for d in self.discs if math.hypot(d[0] - x, d[1] - y) < reach]
        full, _ = self.floor.scan(x, y, heading + first, laser.range_m, around, [], near)
        ranges = np.asarray(full[: laser.beams])
        hit = ranges < laser.range_m
        noisy = ranges + random.normal(0.0, laser.noise_m, len(ranges)).astype(np.float32)
        ranges = np.where(hit, np.maximum(noisy, 0.02), laser.range_m).astype(np.float32)
        return RangeScan(time_s, ranges, first, step, laser.range_m, odometry)


def along(corners: Sequence[tuple[float, float]], step_m: float, turn_rad: float = 0.3) -> Poses:
    """(n, 3): poses along a polyline."""
    poses: list[tuple[float, float, float]] = []
    heading: float | None = None
    for (ax, ay), (bx, by) in itertools.pairwise(corners):
        length = math.hypot(bx - ax, by - ay)
        if length < 1e-6:
            continue
        ahead = math.atan2(by - ay, bx - ax)
        if heading is not None:
            turn = math.remainder(ahead - heading, math.tau)
            for part in range(1, int(abs(turn) / turn_rad) + 1):
                poses.append((ax, ay, heading + math.copysign(part * turn_rad, turn)))
        heading = ahead
        count = max(1, round(length / step_m))
        for part in range(count):
            share = part / count
            poses.append((ax + share * (bx - ax), ay + share * (by - ay), ahead))
    poses.append((*corners[-1], heading or 0.0))
    return np.array(poses)


def _measured(motion: Poses, noise: OdometryNoise, random: np.random.Generator) -> Poses:
    length, turn = float(np.hypot(motion[0], motion[1])), abs(float(motion[2]))
    stretch = 1.0 + noise.length_bias + random.normal(0.0, noise.metre_per_metre)
    twist = random.normal(
        0.0, math.hypot(noise.radian_per_radian * turn, noise.radian_per_metre * length)
    )
    return np.array([motion[0] * stretch, motion[1] * stretch, motion[2] + twist])
