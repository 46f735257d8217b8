"""How well critical points find doorways: precision and recall against labels made by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.maps.floor_plan import Segment
from service.coordination.segmentation.segmentation import SegmentationParameters, segment

WITHIN_M = 1.0
"""a critical point this near to a labelled doorway is at it"""


@dataclass(frozen=True)
class Score:
    """Counts over one or more maps; sums with `+`."""

    found: int = 0
    """labelled doorways with a critical point"""
    doorways: int = 0
    at_doorways: int = 0
    """critical points at a labelled doorway"""
    points: int = 0

    def __add__(self, other: Score) -> Score:
        return Score(
            self.found + other.found,
            self.doorways + other.doorways,
            self.at_doorways + other.at_doorways,
            self.points + other.points,
        )

    @property
    def precision(self) -> float:
        """Share of the critical points that are at a doorway; 1 without any point."""
        return self.at_doorways / self.points if self.points else 1.0

    @property
    def recall(self) -> float:
        """Share of the doorways that have a critical point; 1 without any doorway."""
        return self.found / self.doorways if self.doorways else 1.0


def score(
    cells: NDArray[np.int8],
    resolution_m: float,
    doorways_m: Sequence[Segment],
    parameters: SegmentationParameters,
) -> Score:
    """Of one map, complete or in part; doorways that are not known yet do not count.

    A doorway counts when it is free from jamb to jamb and known half a metre to both sides.
    """
    known = [doorway for doorway in doorways_m if _is_known(cells, resolution_m, doorway)]
    critical = segment(cells, resolution_m, parameters).critical
    rows, columns = np.divmod(np.array(critical, dtype=np.int64), cells.shape[1])
    points = (np.stack([columns, rows], axis=1) + 0.5) * resolution_m
    apart = np.array([[_distance(point, doorway) for doorway in doorways_m] for point in points])
    at_any = (apart <= WITHIN_M).any(axis=1) if apart.size else np.zeros(len(points), np.bool_)
    near = [any(_distance(point, doorway) <= WITHIN_M for point in points) for doorway in known]
    return Score(sum(near), len(known), int(at_any.sum()), len(points))


def _is_known(cells: NDArray[np.int8], resolution_m: float, doorway: Segment) -> bool:
    (x0, y0), (x1, y1) = doorway
    length = float(np.hypot(x1 - x0, y1 - y0))
    if length == 0.0:
        return False
    across = np.array([-(y1 - y0), x1 - x0]) / length
    middle = np.array([(x0 + x1) / 2, (y0 + y1) / 2])
    for share in (-0.5, 0.0, 0.5):
        x, y = middle + share * across
        row, column = int(y / resolution_m), int(x / resolution_m)
        inside = 0 <= row < cells.shape[0] and 0 <= column < cells.shape[1]
        if not inside or cells[row, column] < 0:
            return False
    return True


def _distance(point: NDArray[np.float64], doorway: Segment) -> float:
    """From a point to a segment [m]."""
    a, b = np.array(doorway[0]), np.array(doorway[1])
    along = b - a
    share = np.clip((point - a) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
    return float(np.linalg.norm(point - (a + share * along)))
