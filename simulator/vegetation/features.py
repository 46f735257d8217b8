"""Features of laser measurements: range, incidence angle, remission (sections 6.3 and 6.3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

MAX_RANGE_M = 5.0
"""Farther measurements are too sparse to say anything about the ground (section 6.9)."""
REMISSION_FEATURES = ("range_m", "incidence_rad", "remission")


@dataclass(frozen=True, slots=True)
class Measurements:
    """Laser measurements of surfaces; arrays of shape `(n,)`."""

    range_m: NDArray[np.float64]
    incidence_rad: NDArray[np.float64]
    """Angle between beam and surface normal, 0 to pi/2."""
    remission: NDArray[np.float64]
    """In the scanner's own unit."""

    def __len__(self) -> int:
        return len(self.range_m)

    def __getitem__(self, chosen: NDArray[np.bool_] | NDArray[np.intp]) -> Measurements:
        return Measurements(
            self.range_m[chosen], self.incidence_rad[chosen], self.remission[chosen]
        )

    def features(self) -> NDArray[np.float64]:
        """`(n, 3)`: the columns `REMISSION_FEATURES`."""
        return np.column_stack([self.range_m, self.incidence_rad, self.remission])

    @staticmethod
    def joined(parts: list[Measurements]) -> Measurements:
        """One after the other."""
        return Measurements(
            np.concatenate([part.range_m for part in parts]),
            np.concatenate([part.incidence_rad for part in parts]),
            np.concatenate([part.remission for part in parts]),
        )


def surface_normals(points_m: NDArray[np.float64], neighbours: int = 40) -> NDArray[np.float64]:
    """Unit normals `(n, 3)` of the surface that points `(n, 3)` lie on; their sign is arbitrary.

    The eigenvector of the smallest eigenvalue of the covariance of each point's nearest neighbours
    (section 6.3). O(n log n).
    """
    count = min(neighbours, len(points_m))
    if count < 3:
        return np.tile([0.0, 0.0, 1.0], (len(points_m), 1))
    nearest = np.asarray(cKDTree(points_m).query(points_m, count)[1], dtype=np.intp)
    return _smallest_eigenvectors(points_m, nearest)


def _smallest_eigenvectors(
    points_m: NDArray[np.float64], nearest: NDArray[np.intp], chunk: int = 20_000
) -> NDArray[np.float64]:
    normals = np.empty_like(points_m)
    for begin in range(0, len(points_m), chunk):
        around = points_m[nearest[begin : begin + chunk]]
        around = around - around.mean(axis=1, keepdims=True)
        covariances = np.einsum("nki,nkj->nij", around, around)
        normals[begin : begin + chunk] = np.linalg.eigh(covariances)[1][:, :, 0]
    return normals


def incidence_angles(
    points_m: NDArray[np.float64],
    normals: NDArray[np.float64],
    sensor_m: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Angles `(n,)` [rad] between beams from `sensor_m` `(3,)` or `(n, 3)` and surface normals."""
    beams = points_m - sensor_m
    lengths = np.maximum(np.linalg.norm(beams, axis=1), 1e-9)
    cosines = np.abs(np.einsum("ni,ni->n", beams, normals)) / lengths
    return np.asarray(np.arccos(np.minimum(cosines, 1.0)))


def measure(
    points_m: NDArray[np.float64],
    remission: NDArray[np.float64],
    sensor_m: NDArray[np.float64],
    neighbours: int = 40,
) -> Measurements:
    """Measurements of one 3D scan: points `(n, 3)` and the scanner's position in the same frame.

    `sensor_m` is `(3,)`, or `(n, 3)` for a scanner that moved while it scanned.
    """
    range_m = np.linalg.norm(points_m - sensor_m, axis=1)
    angles = incidence_angles(points_m, surface_normals(points_m, neighbours), sensor_m)
    return Measurements(range_m, angles, np.asarray(remission, dtype=np.float64))
