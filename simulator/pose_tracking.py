"""Where robots believe they are: odometry that drifts, corrected by scans against the known map.

Robots drive by what they believe. What is measured relative to the body (laser, bumper, the guard
that brakes before anything is touched) goes by where the body truly is. Nobody but the drifting
odometry and the scan matching makes a belief: no beacon, no look at the truth.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from simulator.fleet_scenario import Noise, Pose
from simulator.occupancy_grid import OccupancyGrid
from simulator.robot import Robot, wrap
from simulator.sensors import Scan
from simulator.slam.pose import Poses, between, inverse
from simulator.slam.range_scan import RangeScan
from simulator.slam.scan_matching import ScanMatch, ScanMatchParameters, Surfaces, match, refine
from simulator.world import wall_segments

_CORRECTED_EVERY_S = 1.0
"""how often a robot matches a scan to the map at least"""
_DRIFT_M, _DRIFT_RAD = 0.02, 0.02
"""standard deviations of what has been driven since that ask for a match at the next scan"""
_STALLED_S = 1.5
"""a robot that has not got on for so long mistrusts its belief"""
_SPACING_M = 0.05
_LEAST_SCORE = 0.6
"""share of a scan's points that have to lie near walls of the map for a match to count"""
_WINDOW = (0.5, 0.2)
"""how far from its belief a robot looks for a match that it has lost [m], [rad]"""
_START = np.diag([1e-4, 1e-4, 1e-5])
"""covariance of a start pose"""
_STILL = np.diag([1e-6, 1e-6, 1e-7])
"""what a belief loses between two corrections without any motion"""


def drifts(noise: Noise) -> bool:
    """Whether there is any odometry noise."""
    return noise.odometry_m > 0.0 or noise.odometry_rad > 0.0 or noise.odometry_rad_per_m > 0.0


class PoseTracking:
    """Beliefs of all robots."""

    def __init__(self, noise: Noise, seed: int) -> None:
        self.noise = noise
        self.errors: dict[str, list[tuple[float, float]]] = {}
        """robot -> its errors of position [m] and heading [rad] at every `note`"""
        self._random = np.random.default_rng([seed, 1])
        self._covariance: dict[str, NDArray[np.float64]] = {}
        self._corrected: dict[str, Poses] = {}
        self._corrected_s: dict[str, float] = {}
        self._moved: dict[str, tuple[float, float]] = {}
        self._surfaces: tuple[OccupancyGrid, Surfaces] | None = None
        self._parameters = ScanMatchParameters(reach_m=0.5, iterations=8, debias=False)

    # --- odometry ---

    def move(self, robot: Robot, body: Pose) -> None:
        """The body has moved to `body`; the belief moves on by what the odometry makes of that."""
        x, y, heading = robot.truth
        robot.body = body
        dx, dy, turn = body[0] - x, body[1] - y, wrap(body[2] - heading)
        if dx == dy == turn == 0.0:
            return
        cosine, sine = math.cos(heading), math.sin(heading)
        far_m = math.hypot(dx, dy)
        spread_m = self.noise.odometry_m * math.sqrt(far_m)
        spread_rad = math.sqrt(self._heading_variance(far_m, abs(turn)))
        along, across, twist = self._random.normal(0.0, 1.0, 3).tolist()
        ahead = cosine * dx + sine * dy + spread_m * along
        aside = cosine * dy - sine * dx + spread_m * across
        cosine, sine = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
        robot.x += cosine * ahead - sine * aside
        robot.y += sine * ahead + cosine * aside
        robot.heading_rad = wrap(robot.heading_rad + turn + spread_rad * twist)
        driven_m, turned = self._moved.get(robot.id, (0.0, 0.0))
        self._moved[robot.id] = (driven_m + far_m, turned + abs(turn))

    def board(self, robot: Robot, carrier: Robot) -> None:
        """A robot that is carried is where its carrier is, and believes so."""
        robot.x, robot.y, robot.heading_rad = carrier.pose
        robot.body = carrier.truth
        self._covariance.pop(robot.id, None)
        self._corrected.pop(robot.id, None)
        self._moved.pop(robot.id, None)

    def _heading_variance(self, driven_m: float, turned_rad: float) -> float:
        noise = self.noise
        return noise.odometry_rad**2 * turned_rad + noise.odometry_rad_per_m**2 * driven_m

    # --- correction ---

    def is_due(self, robot: Robot, time_s: float) -> bool:
        """Whether the robot should match its scan to the map."""
        if time_s - self._corrected_s.get(robot.id, 0.0) >= _CORRECTED_EVERY_S - 1e-9:
            return True
        driven_m, turned = self._moved.get(robot.id, (0.0, 0.0))
        return (
            self.noise.odometry_m**2 * driven_m > _DRIFT_M**2
            or self._heading_variance(driven_m, turned) > _DRIFT_RAD**2
        )

    def correct(self, robot: Robot, scan: Scan, grid: OccupancyGrid) -> None:
        """Matches a scan to the walls of the map and takes what it tells into the belief."""
        self._corrected_s[robot.id] = scan.time_s
        reference = self._reference(grid)
        belief: Poses = np.array(robot.pose)
        covariance = self._predicted(robot, belief)
        prior = np.asarray(np.linalg.inv(covariance), dtype=np.float64)
        lost = robot.stalled_s > _STALLED_S
        found = self._matched(reference, _range_scan(scan), belief, prior, lost)
        if found is not None:
            covariance = np.asarray(np.linalg.inv(prior + found.information), dtype=np.float64)
            belief = found.pose
            robot.x, robot.y, robot.heading_rad = (float(value) for value in belief)
        self._covariance[robot.id] = covariance
        self._corrected[robot.id] = belief
        self._moved[robot.id] = (0.0, 0.0)

    def _predicted(self, robot: Robot, belief: Poses) -> NDArray[np.float64]:
        """Covariance (3, 3) of the belief before the correction, in the robot's own frame."""
        covariance = self._covariance.get(robot.id)
        if covariance is None:
            covariance = _START if robot.id not in self._corrected else 4.0 * _START
        since = self._corrected.get(robot.id, belief)
        adjoint = _adjoint(inverse(between(since, belief)))
        driven_m, turned = self._moved.get(robot.id, (0.0, 0.0))
        along = self.noise.odometry_m**2 * driven_m
        twist = self._heading_variance(driven_m, turned)
        # A heading that is off by that on the way puts the position off sideways.
        across = along + twist * driven_m**2 / 3.0
        return np.asarray(
            adjoint @ covariance @ adjoint.T + np.diag([along, across, twist]) + _STILL
        )

    def _matched(
        self,
        reference: Surfaces,
        scan: RangeScan,
        belief: Poses,
        prior: NDArray[np.float64],
        lost: bool,
    ) -> ScanMatch | None:
        points = scan.points(self._parameters.spacing_m)
        if len(points) < 10:
            return None
        found = None
        if not lost:
            found = refine(reference, points, belief, self._parameters, prior=prior)
        if found is None or found.score < _LEAST_SCORE:
            found = match(reference, scan, belief, _WINDOW, self._parameters, prior=prior)
        return found if found is not None and found.score >= _LEAST_SCORE else None

    def _reference(self, grid: OccupancyGrid) -> Surfaces:
        if self._surfaces is None or self._surfaces[0] is not grid:
            self._surfaces = (grid, wall_surfaces(grid))
        return self._surfaces[1]

    # --- account ---

    def note(self, robot: Robot) -> None:
        """Writes down by how much the belief is off."""
        x, y, heading = robot.truth
        off_m = math.hypot(robot.x - x, robot.y - y)
        off_rad = abs(wrap(robot.heading_rad - heading))
        self.errors.setdefault(robot.id, []).append((off_m, off_rad))


def wall_surfaces(grid: OccupancyGrid) -> Surfaces:
    """Points along the outlines of a map's walls and along its border, with normals."""
    points, normals = [], []
    for (ax, ay), (bx, by) in wall_segments(grid.cells >= 50, grid.resolution_m, grid.origin_m):
        count = max(1, round(math.hypot(bx - ax, by - ay) / _SPACING_M))
        shares = (np.arange(count) + 0.5) / count
        points.append(np.column_stack([ax + shares * (bx - ax), ay + shares * (by - ay)]))
        normals.append(np.tile([float(ax == bx), float(ay == by)], (count, 1)))
    joined = np.concatenate(points)
    return Surfaces(joined, np.concatenate(normals), KDTree(joined))


def _range_scan(scan: Scan) -> RangeScan:
    step_rad = math.tau / len(scan.ranges_m)
    return RangeScan(scan.time_s, scan.ranges_m, 0.0, step_rad, scan.range_m, np.array(scan.pose))


def _adjoint(motion: Poses) -> NDArray[np.float64]:
    """(3, 3): small motions before `motion` as small motions after its inverse (Sola et al.,
    "A micro Lie theory for state estimation in robotics", 2018, example 6)."""
    x, y, heading = (float(value) for value in motion)
    cosine, sine = math.cos(heading), math.sin(heading)
    return np.array([[cosine, -sine, y], [sine, cosine, -x], [0.0, 0.0, 1.0]])
