"""A robot model's outline on a grid map: what motions are checked against."""

from math import hypot

import numpy as np
from numpy.typing import NDArray

from semantic_attachments._core import Footprint
from semantic_attachments.grid_map import GridMap, PositionM
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.world import OCCUPIED_FROM


class Outline:
    """Collision tests in map coordinates; a footprint that is not convex is replaced by its
    hull."""

    def __init__(self, model: RobotModel, grid: GridMap, unknown_is_free: bool = False) -> None:
        self._grid = grid
        solid = grid.cells >= OCCUPIED_FROM
        if not unknown_is_free:
            solid |= grid.cells < 0
        forbidden = np.zeros_like(solid)
        barred = np.array([name not in model.enters for name in grid.terrain_classes])
        if barred.any():
            terrain = np.zeros_like(grid.cells, np.uint8) if grid.terrain is None else grid.terrain
            forbidden = forbidden | barred[terrain]
        self.solid = solid
        """(height, width) obstacles and, unless they count as free, unknown cells."""
        self.standable = ~solid & ~forbidden
        """(height, width) cells where the reference point may be."""
        from scipy import ndimage  # imported late: it takes longer than a first plan

        padded = np.pad(~solid, 1, constant_values=False)
        clearance = ndimage.distance_transform_edt(padded)[1:-1, 1:-1].astype(np.float32)
        self.clearance_cells = clearance
        """(height, width) distance from the centre of each cell to that of the nearest obstacle,
        the outside of the map included."""
        corners = hull(model.footprint_m)
        self.outer_radius_m = max((hypot(x, y) for x, y in corners), default=model.radius_m)
        """Radius of the least disc around the reference point that contains the outline [m]."""
        room_cells = clearance - self.outer_radius_m / grid.resolution_m
        if forbidden.any():
            to_terrain = ndimage.distance_transform_edt(~forbidden)
            room_cells = np.minimum(room_cells, to_terrain)
        # A position is off its cell's centre, and an obstacle reaches beyond its cell's.
        self._room_m = (room_cells - 1.5) * grid.resolution_m
        self._footprint = Footprint(
            solid,
            forbidden,
            np.nextafter(clearance, np.float32(0)),
            [[x / grid.resolution_m, y / grid.resolution_m] for x, y in corners],
            model.radius_m / grid.resolution_m,
        )

    def is_free(self, x: float, y: float, heading: float) -> bool:
        """Whether the robot can stand at a pose."""
        origin, resolution_m = self._grid.origin_m, self._grid.resolution_m
        return self._footprint.is_free(
            (x - origin[0]) / resolution_m, (y - origin[1]) / resolution_m, heading
        )

    def room_m(self, position_m: PositionM) -> float:
        """How far the robot may move from a position, whatever its headings; negative if it may
        not stand there in all of them [m]."""
        cell = self._grid.cell_at(position_m)
        return -1.0 if cell is None else float(self._room_m.flat[cell])

    def all_free(self, poses: NDArray[np.float64]) -> bool:
        """Whether it can stand at all of (n, 3) poses."""
        return self._footprint.all_free(self._in_cells(poses))

    def hits(self, poses: NDArray[np.float64], cells: NDArray[np.uint32]) -> bool:
        """Whether it overlaps one of some cells at some of (n, 3) poses."""
        return self._footprint.hits(self._in_cells(poses), cells)

    def _in_cells(self, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        scaled = np.array(poses, dtype=np.float64)
        scaled[:, :2] = (scaled[:, :2] - np.array(self._grid.origin_m)) / self._grid.resolution_m
        return scaled


def hull(corners: tuple[tuple[float, float], ...]) -> NDArray[np.float64]:
    """(n, 2) corners of the convex hull, counter-clockwise."""
    points = np.array(corners, dtype=np.float64).reshape(-1, 2)
    from scipy.spatial import ConvexHull  # imported late: it takes longer than a first plan

    return np.asarray(points[ConvexHull(points).vertices]) if len(points) else points


def inner_radius_m(model: RobotModel) -> float:
    """Radius of the largest disc around the reference point inside of the outline [m]."""
    corners = hull(model.footprint_m)
    if not len(corners):
        return model.radius_m
    ahead = np.roll(corners, -1, axis=0) - corners
    # Distance of each edge's line from the reference point; negative if that lies outside of the
    # outline.
    away = (corners[:, 0] * ahead[:, 1] - corners[:, 1] * ahead[:, 0]) / np.hypot(*ahead.T)
    return max(float(away.min()), 0.0)
