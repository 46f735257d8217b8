"""Landmark maps: positions seen again and again, associated by nearness and averaged.

Thesis 4.4: landmarks carry no identity; within one robot's frame the pose graph is good enough to
find the landmark that a detection belongs to in its neighbourhood. Each landmark is a Kalman filter
of its position (4.6.2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from simulator.slam.pose import Points, Poses, transform


@dataclass(frozen=True, slots=True)
class LandmarkParameters:
    """How detections become landmarks."""

    gate_m: float = 1.5
    """a detection belongs to the nearest landmark not farther than that"""
    range_deviation_m: float = 0.05
    bearing_deviation_rad: float = 0.005
    least_sightings: int = 3
    """landmarks seen less often are taken for false detections"""


@dataclass(frozen=True, slots=True, eq=False)
class LandmarkMap:
    """Landmark positions in one robot's frame."""

    positions_m: Points
    """(n, 2)"""
    deviations_m: NDArray[np.float64]
    """(n,): standard deviation of each position along its worse axis"""


class LandmarkMapper:
    """Takes detections from known poses; `landmark_map` is what they make."""

    def __init__(self, parameters: LandmarkParameters | None = None) -> None:
        self.parameters = parameters or LandmarkParameters()
        self._means = np.zeros((0, 2))
        self._covariances = np.zeros((0, 2, 2))
        self._counts = np.zeros(0, dtype=np.int64)

    def add(self, pose: Poses, detections_m: Points) -> NDArray[np.int64]:
        """Takes in detections (n, 2) in the robot's frame; returns the number of each landmark."""
        if len(detections_m) == 0:
            return np.zeros(0, dtype=np.int64)
        seen = transform(pose, detections_m)
        noise = self._noise(pose, detections_m)
        numbers = self._associate(seen)
        for place, number in enumerate(numbers.tolist()):
            if number >= 0:
                self._update(number, seen[place], noise[place])
            else:
                numbers[place] = len(self._means)
                self._means = np.concatenate([self._means, seen[place][None]])
                self._covariances = np.concatenate([self._covariances, noise[place][None]])
                self._counts = np.append(self._counts, 1)
        return numbers

    def landmark_map(self) -> LandmarkMap:
        """Landmarks that were seen often enough."""
        sure = self._counts >= self.parameters.least_sightings
        worse = np.linalg.eigvalsh(self._covariances[sure])[:, -1] if np.any(sure) else np.zeros(0)
        return LandmarkMap(self._means[sure].copy(), np.sqrt(worse))

    def _noise(self, pose: Poses, detections_m: Points) -> NDArray[np.float64]:
        """(n, 2, 2): covariance of the detections in the map's frame."""
        bearing = np.arctan2(detections_m[:, 1], detections_m[:, 0]) + pose[2]
        reach = np.hypot(detections_m[:, 0], detections_m[:, 1])
        radial = np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
        across = np.stack([-radial[:, 1], radial[:, 0]], axis=1)
        along = self.parameters.range_deviation_m**2
        sideways = (self.parameters.bearing_deviation_rad * reach) ** 2 + 1e-6
        return np.asarray(
            along * radial[:, :, None] * radial[:, None, :]
            + sideways[:, None, None] * across[:, :, None] * across[:, None, :]
        )

    def _associate(self, seen: Points) -> NDArray[np.int64]:
        """(n,): nearest landmark of each detection, -1 for a new one; one detection a landmark."""
        numbers = np.full(len(seen), -1, dtype=np.int64)
        if len(self._means) == 0:
            return numbers
        found = KDTree(self._means).query(seen, distance_upper_bound=self.parameters.gate_m)
        apart, nearest = np.asarray(found[0]), np.asarray(found[1])
        taken: set[int] = set()
        for place in np.argsort(apart, kind="stable").tolist():
            number = int(nearest[place])
            if np.isfinite(apart[place]) and number not in taken:
                taken.add(number)
                numbers[place] = number
        return numbers

    def _update(self, number: int, at: Points, noise: NDArray[np.float64]) -> None:
        """The Kalman filter's update of a landmark that stands still."""
        covariance = self._covariances[number]
        gain = covariance @ np.linalg.inv(covariance + noise)
        self._means[number] += gain @ (at - self._means[number])
        self._covariances[number] = (np.eye(2) - gain) @ covariance
        self._counts[number] += 1
