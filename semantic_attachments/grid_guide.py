"""Poses along the grid path of a disc inside a robot's outline: where random poses seldom are, in
doors and corridors."""

from collections.abc import Callable, Sequence
from math import atan2, pi

import numpy as np
from numpy.typing import NDArray

from semantic_attachments._core import Traversability
from semantic_attachments.grid_map import GridMap, PositionM
from semantic_attachments.outline import Outline, inner_radius_m
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.steering import Pose
from semantic_attachments.world import Blockade

_MAPS = 8
"""Maps of closed blockades that are kept."""


class GridGuide:
    """Guides one robot model on one map; its paths keep off walls where there is room."""

    def __init__(
        self,
        model: RobotModel,
        outline: Outline,
        grid: GridMap,
        headings: int,
        blockade_cells: Callable[[Blockade], NDArray[np.uint32]],
    ) -> None:
        self._outline = outline
        self._grid = grid
        self._headings = headings
        self._blockade_cells = blockade_cells
        self._inner_cells = inner_radius_m(model) / grid.resolution_m
        self._outer_cells = outline.outer_radius_m / grid.resolution_m
        self._maps: dict[frozenset[Blockade], Traversability] = {}

    def poses(
        self, start: PositionM, goal: PositionM, closed: Sequence[Blockade]
    ) -> list[Pose] | None:
        """Free poses along the way; None if the disc does not get there, so the outline does
        not."""
        map_ = self._map(closed)
        limit = 3 + 2 * self._outer_cells
        cells = [self._grid.cell_at(position_m) for position_m in (start, goal)]
        ends = [map_.nearest(cell, [], limit) for cell in cells if cell is not None]
        if len(ends) < 2:
            return None
        if ends[0] is None or ends[1] is None:
            return []
        way_m = self._grid.centres_m(map_.field(ends[0][0]).path_to(ends[1][0]))
        if not len(way_m):
            return None
        stride = max(round(self._outer_cells), 1)
        found: list[Pose] = []
        for index in range(0, len(way_m), stride):
            ahead_m = way_m[min(index + stride, len(way_m) - 1)]
            behind_m = way_m[max(index - stride, 0)]
            heading = atan2(*(ahead_m - behind_m)[::-1]) if self._headings > 1 else 0.0
            x, y = way_m[index].tolist()
            headings = [heading] if self._headings == 1 else [heading, heading + pi]
            poses = [(x, y, (h + pi) % (2 * pi) - pi) for h in headings]
            found.extend(pose for pose in poses if self._outline.is_free(*pose))
        return found

    def _map(self, closed: Sequence[Blockade]) -> Traversability:
        key = frozenset(closed)
        if key not in self._maps:
            if len(self._maps) >= _MAPS:
                self._maps.clear()
            zone = 2 * (self._outer_cells + 1)
            gap = np.minimum(self._outline.clearance_cells, zone)
            self._maps[key] = Traversability(
                self._outline.solid,
                ~self._outline.standable & ~self._outline.solid,
                # A disc smaller by what cells may hide passes wherever the inner disc does.
                max(self._inner_cells - 1.5, 0.0),
                (1 + 4 * np.clip(1 - gap / zone, 0, 1)).astype(np.float32),
                [self._blockade_cells(blockade) for blockade in closed],
            )
        return self._maps[key]
