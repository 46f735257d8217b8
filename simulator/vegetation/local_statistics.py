"""Statistics of the neighbourhoods of laser points at several scales.

A single beam of a spinning 3D scanner says little about the ground it hit. How rough the surface
around it is, and how its remission is distributed there, says more.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]
RADII_M = (0.2, 0.4, 0.8, 1.6)
ROUGHNESS = ("plane_deviation_m", "plane_deviation_share", "farthest_from_plane_m")
REMISSION = ("remission_mean", "remission_deviation", "remission_median")
LEAST_NEIGHBOURS = 10


def local_statistics(
    points_m: Array,
    remission: Array,
    chosen: NDArray[np.intp],
    radius_m: float,
    chunk: int = 500,
) -> Array:
    """Incidence angle, `ROUGHNESS` and `REMISSION` `(k, 7)` around the points numbered `chosen`.

    Neighbours are all returns within `radius_m`, or the nearest ten where that is fewer; points
    `(n, 3)` are in the sensor's frame.
    """
    tree = cKDTree(points_m)
    found = np.empty((len(chosen), 7))
    for begin in range(0, len(chosen), chunk):
        part = chosen[begin : begin + chunk]
        around: Any = tree.query_ball_point(points_m[part], radius_m)
        few = np.array([len(neighbours) < LEAST_NEIGHBOURS for neighbours in around])
        if few.any():
            nearest = np.asarray(tree.query(points_m[part[few]], LEAST_NEIGHBOURS)[1])
            for k, neighbours in zip(np.flatnonzero(few), nearest, strict=True):
                around[k] = neighbours.tolist()
        found[begin : begin + chunk] = _of_neighbourhoods(points_m, remission, part, around)
    return found


def _of_neighbourhoods(
    points_m: Array, remission: Array, part: NDArray[np.intp], around: Sequence[Sequence[int]]
) -> Array:
    counts = np.array([len(neighbours) for neighbours in around])
    members = np.concatenate([np.asarray(neighbours) for neighbours in around]).astype(np.intp)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    owner = np.repeat(np.arange(len(part)), counts)
    n = counts[:, None]
    centre = np.add.reduceat(points_m[members], starts) / n
    offset = points_m[members] - centre[owner]
    products = np.einsum("ki,kj->kij", offset, offset).reshape(-1, 9)
    covariance = (np.add.reduceat(products, starts) / n).reshape(-1, 3, 3)
    variances, axes = np.linalg.eigh(covariance)
    variances = np.maximum(variances, 0.0)
    normal = axes[:, :, 0]
    from_plane = np.abs(np.einsum("ki,ki->k", offset, normal[owner]))
    at = points_m[part]
    cosine = np.abs(np.einsum("ni,ni->n", at, normal)) / np.linalg.norm(at, axis=1)
    values = remission[members]
    mean = np.add.reduceat(values, starts) / counts
    variance = np.add.reduceat((values - mean[owner]) ** 2, starts) / counts
    ordered = values[np.lexsort((values, owner))]
    return np.column_stack(
        [
            np.arccos(np.minimum(cosine, 1.0)),
            np.sqrt(variances[:, 0]),
            np.sqrt(variances[:, 0] / np.maximum(variances.sum(axis=1), 1e-12)),
            np.maximum.reduceat(from_plane, starts),
            mean,
            np.sqrt(variance),
            ordered[starts + counts // 2],
        ]
    )
