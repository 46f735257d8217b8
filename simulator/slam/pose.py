"""Rigid motions of the plane: arrays (..., 3) of x [m], y [m] and heading [rad].

A pose is the motion from the frame it is given in to the robot's own frame; `compose(a, b)` is
"first a, then b as seen from a". Every function broadcasts over leading axes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Poses = NDArray[np.float64]
"""(..., 3): x [m], y [m], heading [rad]"""
Points = NDArray[np.float64]
"""(..., 2): x [m], y [m]"""


def wrap(angle_rad: ArrayLike) -> NDArray[np.float64]:
    """The same angles in [-pi, pi)."""
    angles = np.asarray(angle_rad, dtype=np.float64)
    return np.asarray((angles + np.pi) % (2.0 * np.pi) - np.pi)


def compose(first: ArrayLike, then: ArrayLike) -> Poses:
    """The motion `first`, then `then` in the frame that `first` leads to."""
    a, b = np.asarray(first, dtype=np.float64), np.asarray(then, dtype=np.float64)
    cosine, sine = np.cos(a[..., 2]), np.sin(a[..., 2])
    x = a[..., 0] + cosine * b[..., 0] - sine * b[..., 1]
    y = a[..., 1] + sine * b[..., 0] + cosine * b[..., 1]
    return np.stack([x, y, wrap(a[..., 2] + b[..., 2])], axis=-1)


def inverse(pose: ArrayLike) -> Poses:
    """The motion back."""
    a = np.asarray(pose, dtype=np.float64)
    cosine, sine = np.cos(a[..., 2]), np.sin(a[..., 2])
    x = -cosine * a[..., 0] - sine * a[..., 1]
    y = sine * a[..., 0] - cosine * a[..., 1]
    return np.stack([x, y, wrap(-a[..., 2])], axis=-1)


def between(start: ArrayLike, end: ArrayLike) -> Poses:
    """`end` as seen from `start`."""
    return compose(inverse(start), end)


def transform(pose: ArrayLike, points_m: ArrayLike) -> Points:
    """Points (..., n, 2) of the pose's own frame in the frame that the pose is given in."""
    a, p = np.asarray(pose, dtype=np.float64), np.asarray(points_m, dtype=np.float64)
    cosine, sine = np.cos(a[..., 2])[..., None], np.sin(a[..., 2])[..., None]
    x = a[..., 0][..., None] + cosine * p[..., 0] - sine * p[..., 1]
    y = a[..., 1][..., None] + sine * p[..., 0] + cosine * p[..., 1]
    return np.stack([x, y], axis=-1)


def compose_jacobians(
    first: ArrayLike, then: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Derivatives (..., 3, 3) of `compose` by its two arguments' x, y and heading.

    Smith, Self and Cheeseman, "Estimating Uncertain Spatial Relationships in Robotics" (1990).
    """
    a, b = np.asarray(first, dtype=np.float64), np.asarray(then, dtype=np.float64)
    cosine, sine = np.cos(a[..., 2]), np.sin(a[..., 2])
    shape = np.broadcast_shapes(a.shape[:-1], b.shape[:-1])
    by_first = np.broadcast_to(np.eye(3), (*shape, 3, 3)).copy()
    by_first[..., 0, 2] = -sine * b[..., 0] - cosine * b[..., 1]
    by_first[..., 1, 2] = cosine * b[..., 0] - sine * b[..., 1]
    by_then = np.zeros((*shape, 3, 3))
    by_then[..., 0, 0] = by_then[..., 1, 1] = cosine
    by_then[..., 0, 1], by_then[..., 1, 0] = -sine, sine
    by_then[..., 2, 2] = 1.0
    return by_first, by_then


def fit_motion(from_m: Points, to_m: Points, weights: NDArray[np.float64] | None = None) -> Poses:
    """The motion (3,) that brings points (n, 2) closest to others (n, 2) in least squares.

    Umeyama, "Least-Squares Estimation of Transformation Parameters", PAMI 1991, in the plane.

    Raises:
        ValueError: fewer than two points, which no motion is determined by.
    """
    if len(from_m) < 2:
        raise ValueError(f"a motion of the plane needs two points or more, not {len(from_m)}")
    w = np.ones(len(from_m)) if weights is None else weights
    w = w / w.sum()
    centre_a, centre_b = w @ from_m, w @ to_m
    a, b = from_m - centre_a, to_m - centre_b
    sine = float(np.sum(w * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])))
    cosine = float(np.sum(w * (a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1])))
    turn = np.array([0.0, 0.0, np.arctan2(sine, cosine)])
    shift = centre_b - transform(turn, centre_a[None])[0]
    return np.array([shift[0], shift[1], turn[2]])
