"""Which motions a changed map can touch.

Every point of a motion of length L from s to g is within L of s and g, added up. A change that lies
farther than that neither bars the motion nor opens a shorter one.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import hypot
from typing import Self

import numpy as np

from semantic_attachments.grid_map import GridMap, PositionM
from semantic_attachments.world import Blockade


@dataclass(frozen=True, slots=True)
class Box:
    """A region that changed, in the map frame [m]."""

    low_m: PositionM
    high_m: PositionM

    @classmethod
    def around(cls, blockade: Blockade) -> Self:
        """The region of a blockade."""
        xs, ys = zip(*blockade.segment_m, strict=True)
        half_m = blockade.thickness_m / 2
        return cls((min(xs) - half_m, min(ys) - half_m), (max(xs) + half_m, max(ys) + half_m))

    def away_m(self, position_m: PositionM) -> float:
        """Distance of a position; 0 inside."""
        gaps = (
            max(low - value, 0.0, value - high)
            for low, value, high in zip(self.low_m, position_m, self.high_m, strict=True)
        )
        return hypot(*gaps)


def changed_cells(before: GridMap, now: GridMap) -> list[Box] | None:
    """The region whose cells changed, none of them if all are the same; None for another frame."""
    if before == now:
        return []
    frames = [
        (grid.cells.shape, grid.resolution_m, grid.origin_m, grid.terrain_classes)
        for grid in (before, now)
    ]
    if frames[0] != frames[1]:
        return None
    changed = before.cells != now.cells
    if before.terrain is not None or now.terrain is not None:
        zeros = np.zeros_like(before.cells, np.uint8)
        changed |= (zeros if before.terrain is None else before.terrain) != (
            zeros if now.terrain is None else now.terrain
        )
    centres_m = now.centres_m(np.flatnonzero(changed))
    half_m = now.resolution_m / 2
    low_x, low_y = (centres_m.min(axis=0) - half_m).tolist()
    high_x, high_y = (centres_m.max(axis=0) + half_m).tolist()
    return [Box((low_x, low_y), (high_x, high_y))]


def touches(
    boxes: Iterable[Box], ends_m: tuple[PositionM, PositionM], length_m: float, reach_m: float
) -> bool:
    """Whether a motion between two positions may come within reach of one of the boxes."""
    return any(
        sum(box.away_m(position_m) for position_m in ends_m) <= length_m + 2 * reach_m
        for box in boxes
    )
