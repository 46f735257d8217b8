"""Monte Carlo localization in a grid map, from anywhere (thesis 4.3.2, eq. 4.10).

Dellaert, Fox, Burgard and Thrun, "Monte Carlo Localization for Mobile Robots", ICRA 1999, with a
likelihood field as the sensor model (Thrun, Burgard and Fox, Probabilistic Robotics 2005, 6.4) and
as many particles as the spread of the belief needs (Fox, "KLD-Sampling", NIPS 2001).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.stats import norm

from simulator._core import LikelihoodField
from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.odometry import OdometryModel
from simulator.slam.pose import Points, Poses, between, compose, wrap
from simulator.slam.range_scan import RangeScan


@dataclass(frozen=True, slots=True)
class LocalizationParameters:
    """The particle filter and its sensor model."""

    density_m2: float = 30.0
    """particles a square metre of free space at the start"""
    most_particles: int = 40_000
    least_particles: int = 400
    beams: int = 40
    """end points of a scan that are looked up"""
    spread_m: float = 0.2
    """standard deviation of an end point from the nearest wall"""
    stray: float = 0.1
    """share of end points that have nothing to do with the map"""
    independence: float = 0.12
    """share of the looked up end points that count as independent measurements"""
    kld_error: float = 0.05
    kld_quantile: float = 0.99
    kld_bin_m: float = 0.5
    kld_bin_rad: float = 0.26
    converged_mass: float = 0.99
    converged_radius_m: float = 0.5
    """the filter has converged when that mass lies in a circle so wide"""
    motion: OdometryModel = field(
        default_factory=lambda: OdometryModel(
            still_m=0.03, still_rad=0.015, metre_per_metre=0.1, radian_per_radian=0.15
        )
    )


class SensorField:
    """A grid map prepared for looking up end points."""

    def __init__(self, grid: OccupancyGrid, parameters: LocalizationParameters) -> None:
        self.grid = grid
        self.parameters = parameters
        occupied = grid.cells >= 50
        if not np.any(occupied):
            raise ValueError("a map without walls cannot be localized in")
        apart_m = distance_transform_edt(~occupied) * grid.resolution_m
        near = np.exp(-0.5 * (apart_m / parameters.spread_m) ** 2)
        likelihood = (1.0 - parameters.stray) * near + parameters.stray
        self.log_likelihood = LikelihoodField(
            np.log(likelihood).astype(np.float32),
            grid.resolution_m,
            grid.origin_m,
            float(np.log(parameters.stray)),
        )
        self._free = np.argwhere((grid.cells >= 0) & (grid.cells < 50))

    @property
    def free_area_m2(self) -> float:
        """Area where a robot can be."""
        return len(self._free) * self.grid.resolution_m**2

    def anywhere(self, count: int, random: np.random.Generator) -> Poses:
        """(count, 3): uniform over free space and headings."""
        cells = self._free[random.integers(0, len(self._free), count)]
        at = (cells[:, ::-1] + random.random((count, 2))) * self.grid.resolution_m
        heading = random.uniform(-np.pi, np.pi, count)
        return np.column_stack([at + np.array(self.grid.origin_m), heading])

    def mean_log_likelihood(self, poses: Poses, points_m: Points) -> NDArray[np.float64]:
        """(n,): of a scan's end points from each of the poses, per end point."""
        scores = self.log_likelihood.scores(np.ascontiguousarray(poses), points_m)
        return np.asarray(scores / len(points_m), dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class Localized:
    """Where a robot is in another one's map after a sequence of scans."""

    pose: Poses
    """(3,): mean of the particles in the circle, at the last scan"""
    covariance: NDArray[np.float64]
    """(3, 3)"""
    mean_likelihood: float
    """average over the particles of the last scan's likelihood per end point (eq. 4.13)"""
    steps: int
    """scans until the filter had converged for good"""


class MonteCarloLocalization:
    """One belief; reset it by making a new one."""

    def __init__(
        self,
        sensor_field: SensorField,
        random: np.random.Generator,
        parameters: LocalizationParameters | None = None,
    ) -> None:
        self.parameters = parameters or sensor_field.parameters
        self.field = sensor_field
        self.random = random
        wanted = int(self.parameters.density_m2 * sensor_field.free_area_m2)
        count = max(self.parameters.least_particles, min(self.parameters.most_particles, wanted))
        self.particles = sensor_field.anywhere(count, random)
        self.weights = np.full(count, 1.0 / count)

    def move(self, motion: Poses) -> None:
        """The motion model P(x_t | u, x_t-1)."""
        moved = self.parameters.motion.sample(motion, len(self.particles), self.random)
        self.particles = compose(self.particles, moved)

    def see(self, points_m: Points) -> None:
        """The sensor model P(z | x), then resampling if the weights are uneven."""
        if len(points_m) < 5:
            return
        scores = self.field.mean_log_likelihood(self.particles, points_m)
        scores = scores * len(points_m) * self.parameters.independence
        weights = self.weights * np.exp(scores - scores.max())
        self.weights = weights / weights.sum()
        effective = 1.0 / float(np.sum(self.weights**2))
        if effective < 0.5 * len(self.weights):
            self._resample()

    def converged(self) -> tuple[Poses, NDArray[np.float64]] | None:
        """Mean and covariance, if the mass lies in the circle."""
        at = self.particles[:, :2]
        centre = self.weights @ at
        # The mean of several modes may lie far from all of them: look around the heaviest place.
        inside = np.linalg.norm(at - centre, axis=1) <= self.parameters.converged_radius_m
        mass = float(self.weights[inside].sum())
        if mass < self.parameters.converged_mass:
            return None
        weights = self.weights[inside] / mass
        particles = self.particles[inside]
        heading = np.arctan2(weights @ np.sin(particles[:, 2]), weights @ np.cos(particles[:, 2]))
        mean = np.array([*(weights @ particles[:, :2]), heading])
        away = particles - mean
        away[:, 2] = wrap(away[:, 2])
        if weights @ np.abs(away[:, 2]) > 0.3:
            # One place, but several headings: a symmetric room.
            return None
        return mean, np.asarray((away * weights[:, None]).T @ away)

    def _resample(self) -> None:
        """Low-variance resampling, the number of particles by the bins they fill (KLD)."""
        bins = np.floor(
            np.column_stack(
                [
                    self.particles[:, :2] / self.parameters.kld_bin_m,
                    self.particles[:, 2] / self.parameters.kld_bin_rad,
                ]
            )
        ).astype(np.int64)
        heavy = self.weights > 1e-3 / len(self.weights)
        bins -= bins.min(axis=0)
        size = bins.max(axis=0) + 1
        numbers = (bins[:, 0] * size[1] + bins[:, 1]) * size[2] + bins[:, 2]
        filled = len(np.unique(numbers[heavy]))
        count = min(self._particles_for(filled), len(self.particles))
        ladder = (np.arange(count) + self.random.random()) / count
        chosen = np.searchsorted(np.cumsum(self.weights), ladder).clip(0, len(self.weights) - 1)
        self.particles = self.particles[chosen]
        self.weights = np.full(count, 1.0 / count)

    def _particles_for(self, bins: int) -> int:
        """Fox's bound on the sample size by the Wilson-Hilferty approximation."""
        least, most = self.parameters.least_particles, self.parameters.most_particles
        if bins <= 1:
            return least
        k = bins - 1
        root = 1.0 - 2.0 / (9.0 * k)
        root += np.sqrt(2.0 / (9.0 * k)) * float(norm.ppf(self.parameters.kld_quantile))
        return int(min(most, max(least, k / (2.0 * self.parameters.kld_error) * root**3)))


def scan_points(scan: RangeScan, beams: int) -> Points:
    """(n, 2): at most so many end points, evenly spread over those that met something."""
    points = scan.points(0.1)
    if len(points) <= beams:
        return points
    return np.asarray(points[np.linspace(0, len(points) - 1, beams).astype(int)])


def localize(
    sensor_field: SensorField,
    posed: Sequence[tuple[Poses, RangeScan]],
    random: np.random.Generator,
    parameters: LocalizationParameters | None = None,
) -> Localized | None:
    """Global localization by a sequence of scans with relative poses (thesis: d = 40).

    Args:
        sensor_field: the other robot's map.
        posed: the robot's own poses, in whatever frame, and the scans made there.
        random: draws particles.
        parameters: the field's own by default.

    Returns:
        None if the belief has not converged at the end of the sequence.
    """
    parameters = parameters or sensor_field.parameters
    belief = MonteCarloLocalization(sensor_field, random, parameters)
    since: int | None = None
    points = np.zeros((0, 2))
    for place, (pose, scan) in enumerate(posed):
        if place > 0:
            belief.move(between(posed[place - 1][0], pose))
        points = scan_points(scan, parameters.beams)
        belief.see(points)
        since = (place if since is None else since) if belief.converged() else None
    found = belief.converged()
    if found is None or since is None or len(points) < 5:
        return None
    mean, covariance = found
    likelihood = np.exp(sensor_field.mean_log_likelihood(belief.particles, points))
    return Localized(mean, covariance, float(belief.weights @ likelihood), since + 1)
