"""Oriented bounding boxes: from points, and whether two of them meet."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class OrientedBox:
    """A box with axes of its own, in some frame."""

    centre_m: Array
    """`(3,)`."""
    axes: Array
    """Unit axes as the columns of a rotation matrix `(3, 3)`."""
    half_extents_m: Array
    """Half the edges along the axes `(3,)`."""

    @classmethod
    def around(cls, points_m: NDArray[np.floating], margin_m: float = 0.0) -> "OrientedBox":
        """The box along the principal axes of points `(n, 3)`, n > 0, grown by a margin."""
        points = np.asarray(points_m, dtype=np.float64)
        axes = principal_axes(points)
        local = points @ axes
        low, high = local.min(axis=0), local.max(axis=0)
        return cls(axes @ ((low + high) / 2), axes, (high - low) / 2 + margin_m)

    def meets(self, other: "OrientedBox") -> bool:
        """Whether the boxes share a point: no separating axis among the 15 candidates.

        Source: Gottschalk, "Collision queries using oriented bounding boxes", 2000.
        """
        crossed = np.cross(self.axes.T[:, None], other.axes.T[None, :]).reshape(9, 3)
        candidates = np.concatenate([self.axes.T, other.axes.T, crossed])
        reach = np.abs(candidates @ self.axes) @ self.half_extents_m
        reach += np.abs(candidates @ other.axes) @ other.half_extents_m
        gap = np.abs(candidates @ (other.centre_m - self.centre_m))
        # Parallel edges give a zero candidate, which separates nothing.
        return bool((gap <= reach + 1e-12).all())

    def contains(self, points_m: NDArray[np.floating]) -> NDArray[np.bool_]:
        """Which of the points `(n, 3)` lie inside `(n,)`."""
        local = (np.asarray(points_m, dtype=np.float64) - self.centre_m) @ self.axes
        return np.asarray((np.abs(local) <= self.half_extents_m).all(axis=1))

    def clip(
        self, origin_m: Array, points_m: NDArray[np.floating]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Shares of the beams from `origin_m` to each point at which they enter and leave the box.

        Entering later than leaving means that the beam's line misses the box.
        """
        start = (np.asarray(origin_m, dtype=np.float64) - self.centre_m) @ self.axes
        along = (np.asarray(points_m, dtype=np.float64) - origin_m) @ self.axes
        with np.errstate(divide="ignore", invalid="ignore"):
            first = (-self.half_extents_m - start) / along
            second = (self.half_extents_m - start) / along
        parallel = along == 0
        outside = np.abs(start) > self.half_extents_m
        near = np.where(parallel, np.where(outside, np.inf, -np.inf), np.minimum(first, second))
        far = np.where(parallel, np.where(outside, -np.inf, np.inf), np.maximum(first, second))
        enter, leave = near.max(axis=1), far.min(axis=1)
        return enter, leave


def principal_axes(points_m: NDArray[np.floating]) -> Array:
    """Axes of largest to smallest spread of points `(n, 3)`, as the columns of a rotation
    matrix."""
    points = np.asarray(points_m, dtype=np.float64)
    centred = points - points.mean(axis=0)
    _, vectors = np.linalg.eigh(centred.T @ centred)
    axes = vectors[:, ::-1].copy()
    # Signs are fixed so that the same points give the same frame: the largest entry is positive.
    for column in range(2):
        if axes[np.abs(axes[:, column]).argmax(), column] < 0:
            axes[:, column] *= -1
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return axes
