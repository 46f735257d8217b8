"""Which edges of a roadmap a robot can drive: each checked against the map and blockades once.

An edge is a pair of vertices; a pose is (x [m], y [m], heading [rad]).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.grid_map import GridMap
from semantic_attachments.outline import Outline
from semantic_attachments.steering import Pose, Steering
from semantic_attachments.world import Blockade

_FEW = tuple(index / 8 for index in range(1, 8))
"""Shares of an edge that are looked at first: most edges through walls fail there."""


class EdgeCheck:
    """Remembers what it found."""

    def __init__(self, outline: Outline, steering: Steering, grid: GridMap) -> None:
        self.step_m = grid.resolution_m / 2
        """Distance of the poses that are checked."""
        self._outline = outline
        self._steering = steering
        self._grid = grid
        self._free: dict[tuple[int, int], bool] = {}
        self._touches: dict[tuple[int, int, Blockade, bool, bool], bool] = {}
        self._cells: dict[Blockade, NDArray[np.uint32]] = {}

    def is_free(self, edge: tuple[int, int], ends: tuple[Pose, Pose]) -> bool:
        """Whether the way between two vertices is free but for blockades."""
        key = edge if edge[0] < edge[1] or not self._steering.symmetric else edge[::-1]
        if key not in self._free:
            few_are_free = self._outline.all_free(self._steering.at(*ends, _FEW))
            self._free[key] = few_are_free and (
                self._is_free_in_strides(*ends)
                if self._steering.is_costly
                else self._outline.all_free(self._steering.poses(*ends, self.step_m))
            )
        return self._free[key]

    def _is_free_in_strides(self, start: Pose, goal: Pose) -> bool:
        """As far ahead at once as there is room, in single steps near obstacles."""
        length_m = self._steering.length_m(start, goal)
        driven_m = 0.0
        while driven_m < length_m:
            x, y, heading = self._steering.at(start, goal, (driven_m / length_m,))[0].tolist()
            room_m = self._outline.room_m((x, y))
            if room_m <= self.step_m:
                if not self._outline.is_free(x, y, heading):
                    return False
                room_m = self.step_m
            driven_m += room_m
        return self._outline.is_free(*goal)

    def touches(
        self,
        edge: tuple[int, int],
        ends: tuple[Pose, Pose],
        blockade: Blockade,
        *,
        leaves: bool,
        arrives: bool,
    ) -> bool:
        """Whether a robot touches a blockade between two vertices.

        One that was stopped by a blockade stands against it: where it leaves its place, or
        arrives there, poses that only lead away from the blockade, or up to it, do not count.
        """
        key = (*edge, blockade, leaves, arrives)
        if key not in self._touches:
            poses = self._steering.poses(*ends, self.step_m)
            parting = _without_parting(poses, blockade, leaves=leaves, arrives=arrives)
            self._touches[key] = self.poses_touch(parting, blockade)
        return self._touches[key]

    def poses_touch(self, poses: NDArray[np.float64], blockade: Blockade) -> bool:
        """Whether the robot touches a blockade at some of (n, 3) poses."""
        reach_m = self.reach_m(blockade)
        ends = np.array(blockade.segment_m)
        low, high = ends.min(axis=0) - reach_m, ends.max(axis=0) + reach_m
        near = poses[np.all((poses[:, :2] >= low) & (poses[:, :2] <= high), axis=1)]
        return bool(len(near)) and self._outline.hits(near, self.cells(blockade))

    def reach_m(self, blockade: Blockade) -> float:
        """Distance from a blockade's segment beyond which the robot does not touch it."""
        return self._outline.outer_radius_m + blockade.thickness_m + 2 * self._grid.resolution_m

    def walls(self, closed: Sequence[Blockade]) -> list[tuple[float, float, float, float, float]]:
        """Segments of blockades with their reach, as a `LazyGraph` takes them."""
        return [(*b.segment_m[0], *b.segment_m[1], self.reach_m(b)) for b in closed]

    def cells(self, blockade: Blockade) -> NDArray[np.uint32]:
        """(n,) cells of a blockade."""
        if blockade not in self._cells:
            self._cells[blockade] = blockade.cells(self._grid)
        return self._cells[blockade]


def _without_parting(
    poses: NDArray[np.float64], blockade: Blockade, *, leaves: bool, arrives: bool
) -> NDArray[np.float64]:
    start, end = np.array(blockade.segment_m)
    along = end - start
    share = np.clip((poses[:, :2] - start) @ along / max(float(along @ along), 1e-12), 0, 1)
    away_m = np.linalg.norm(poses[:, :2] - (start + share[:, None] * along), axis=1)
    parting, nearing = np.diff(away_m) > 0, np.diff(away_m) < 0
    first = int(np.argmin(np.append(parting, False))) if leaves else 0
    last = int(np.argmin(np.append(nearing[::-1], False))) if arrives else 0
    return poses[first + 1 if first else 0 : len(poses) - (last + 1 if last else 0)]
