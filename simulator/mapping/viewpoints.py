"""Where to measure from: poses around a table that a robot can reach (Wurm, Algorithm 6)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator import _core
from simulator.mapping.hierarchy import MapHierarchy, MapNode
from simulator.occupancy_grid import OccupancyGrid

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Viewpoint:
    """A pose of the sensor in the map frame."""

    position_m: tuple[float, float, float]
    yaw_rad: float
    pitch_rad: float
    """Positive looks down."""


@dataclass(frozen=True, slots=True)
class Platform:
    """The robot that carries the sensor."""

    radius_m: float = 0.3
    speed_m_s: float = 0.5
    sensor_height_m: float = 1.3


class NoWayError(ValueError):
    """No viewpoint can be reached."""


def nearest_table(
    hierarchy: MapHierarchy, position_m: tuple[float, float], explored: frozenset[int]
) -> MapNode | None:
    """The closest table that was not explored yet (findNearestUnexploredTable)."""
    tables = [
        node for node in hierarchy.nodes() if node.label == "table" and node.id not in explored
    ]
    return min(
        tables,
        key=lambda node: float(np.linalg.norm(node.T_map_node[:2, 3] - np.array(position_m))),
        default=None,
    )


class Ways:
    """Travel times on a traversability map, by A*."""

    def __init__(
        self, grid: OccupancyGrid, platform: Platform, start_m: tuple[float, float]
    ) -> None:
        self.platform = platform
        self.start_m = start_m
        # The floor under the robot is hidden from its sensor, but it stands there.
        rows, columns = np.indices(grid.cells.shape)
        x = grid.origin_m[0] + (columns + 0.5) * grid.resolution_m - start_m[0]
        y = grid.origin_m[1] + (rows + 0.5) * grid.resolution_m - start_m[1]
        under = np.hypot(x, y) <= platform.radius_m + 2 * grid.resolution_m
        self.walls = grid.walls() & ~(under & (grid.cells < 0))
        self.resolution_m, self.origin_m = grid.resolution_m, grid.origin_m
        self._floor = _core.Floor(self.walls, grid.resolution_m, grid.origin_m)

    def stands_free(self, position_m: tuple[float, float]) -> bool:
        """Whether the robot's body fits there."""
        radius_m = self.platform.radius_m
        return self._floor.clearance(*position_m, 2 * radius_m) > radius_m

    def travel_time_s(self, goal_m: tuple[float, float]) -> float:
        """Time to drive from the start to a goal; infinite where there is no way."""
        if np.hypot(goal_m[0] - self.start_m[0], goal_m[1] - self.start_m[1]) < 1e-6:
            return 0.0
        route = self._floor.route(self.start_m, [goal_m], self.platform.radius_m, 0.0, 0.1, [], [])
        if route is None:
            return np.inf
        corners = np.array([self.start_m, *route])
        length_m = float(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum())
        return length_m / self.platform.speed_m_s


def sample_viewpoints(
    ways: Ways,
    target_m: tuple[float, float, float],
    radius_m: float,
    count: int,
    random: np.random.Generator,
) -> list[Viewpoint]:
    """Poses from which the target is looked at, spread over the free area within `radius_m`
    of it (sampleTableViewpoints)."""
    found: list[Viewpoint] = []
    x, y, z = target_m
    for _ in range(50 * count):
        if len(found) == count:
            break
        distance_m = radius_m * float(np.sqrt(random.uniform()))
        bearing = random.uniform(-np.pi, np.pi)
        at = (x + distance_m * float(np.cos(bearing)), y + distance_m * float(np.sin(bearing)))
        if ways.stands_free(at):
            found.append(look_at(at, ways.platform.sensor_height_m, (x, y, z)))
    return found


def look_at(
    position_m: tuple[float, float], height_m: float, target_m: tuple[float, float, float]
) -> Viewpoint:
    """The pose at a place and height whose optical axis meets the target."""
    east, north = target_m[0] - position_m[0], target_m[1] - position_m[1]
    return Viewpoint(
        (*position_m, height_m),
        yaw_rad=float(np.arctan2(north, east)),
        pitch_rad=float(np.arctan2(height_m - target_m[2], np.hypot(east, north))),
    )


def look_around(
    position_m: tuple[float, float],
    height_m: float,
    views: int = 6,
    pitches_rad: tuple[float, ...] = (0.2, 0.8, 1.3),
) -> list[Viewpoint]:
    """Views in all directions, as a pan-tilt unit takes them."""
    return [
        Viewpoint((*position_m, height_m), yaw_rad=2 * np.pi * view / views, pitch_rad=pitch)
        for pitch in pitches_rad
        for view in range(views)
    ]
