"""A robot's own navigation: routes on the known map, and how closely they are followed.

The service says where to go and which way; a robot follows that way where its body fits, and
otherwise finds its own around what it knows.
"""

from __future__ import annotations

import itertools
import math
from copy import copy

from simulator._core import Floor
from simulator.fleet_scenario import MARGIN_M, HiddenBlockade, Point, RobotType
from simulator.occupancy_grid import OccupancyGrid
from simulator.robot import Robot
from simulator.segment_geometry import nearest_on_segment, segment_distance

COMFORT_M = 0.2
"""distance that they keep where a small detour allows it"""
REACH_M = 0.45
"""how far from its edge a robot reaches a blockade or another robot"""
_LOOK_AHEAD_M = 0.5
_ON_ROUTE_M = 0.05


class Navigation:
    """Routes for robots that share what they sense."""

    def __init__(self, grid: OccupancyGrid) -> None:
        self.grid = grid
        self.known: dict[str, HiddenBlockade] = {}
        """blockades sensed and not cleared"""
        self.standing: list[tuple[float, float, float]] = []
        """dead robots: x, y, radius"""
        self.walls = Floor(grid.walls(), grid.resolution_m, grid.origin_m)
        self._floors: dict[tuple[str, ...], Floor] = {}

    def learn(self, grid: OccupancyGrid) -> None:
        """The map has changed; routes are found on the new one from now on."""
        self.grid = grid
        self.walls = Floor(grid.walls(), grid.resolution_m, grid.origin_m)
        self._floors = {}

    def copy(self) -> Navigation:
        """The same for robots that lose touch with the others; the floors stay shared."""
        one = copy(self)
        one.known, one.standing, one._floors = (
            dict(self.known),
            list(self.standing),
            dict(self._floors),
        )
        return one

    def floor(self, kind: RobotType) -> Floor:
        """The floor as a kind of robot may use it: its centre stays out of forbidden terrain."""
        if kind.enters not in self._floors:
            forbidden = self.grid.forbidden(kind.enters)
            self._floors[kind.enters] = (
                self.walls.forbidding(forbidden) if forbidden.any() else self.walls
            )
        return self._floors[kind.enters]

    def quads(self) -> list[tuple[float, float, float, float]]:
        """Known blockades as (x, y, x, y)."""
        return [(*b.segment_m[0], *b.segment_m[1]) for b in self.known.values()]

    def standing_but(self, robot: Robot) -> list[tuple[float, float, float]]:
        """Dead robots, without this one."""
        return [disc for disc in self.standing if math.dist(disc[:2], robot.position) > 1e-6]

    def route(self, robot: Robot, goals: list[Point]) -> list[Point] | None:
        """The robot's own way to the nearest of the goals."""
        return self.floor(robot.kind).route(
            robot.position,
            goals,
            robot.kind.radius_m,
            MARGIN_M,
            COMFORT_M,
            self.quads(),
            self.standing_but(robot),
        )

    def accepts(self, robot: Robot, path_m: tuple[Point, ...]) -> bool:
        """Whether the robot's body can follow the service's path as it is."""
        if len(path_m) < 2 or math.dist(path_m[0], robot.position) > 0.5:
            return False
        floor, reach = self.floor(robot.kind), robot.kind.radius_m + MARGIN_M
        points = [robot.position, *path_m[1:]]
        legs = list(itertools.pairwise(points))
        return (
            all(floor.leg_is_clear(*a, *b, reach) for a, b in legs)
            and not self.is_blocked(points, reach)
            and not any(
                segment_distance((disc[:2], disc[:2]), leg) < reach + disc[2]
                for disc in self.standing_but(robot)
                for leg in legs
            )
        )

    def is_blocked(self, points: list[Point], reach_m: float) -> bool:
        """Whether a polyline comes as near as that to a known blockade."""
        return any(
            segment_distance(blockade.segment_m, leg) < reach_m
            for leg in itertools.pairwise(points)
            for blockade in self.known.values()
        )

    def reaches(self, robot: Robot, blockade: HiddenBlockade) -> bool:
        """Whether the robot stands at the blockade's edge, with no wall between."""
        # Both are seen or felt by the robot itself, wherever it believes to be.
        x, y, _ = robot.truth
        nearest = nearest_on_segment((x, y), blockade.segment_m)
        far = math.dist((x, y), nearest)
        if far > robot.kind.radius_m + REACH_M + 0.05:
            return False
        ratio = max(0.0, far - 0.1) / max(far, 1e-9)
        before = (
            x + ratio * (nearest[0] - x),
            y + ratio * (nearest[1] - y),
        )
        return self.walls.leg_is_clear(x, y, *before, 0.0)

    def approaches(self, robot: Robot, blockade: HiddenBlockade) -> list[Point]:
        """Where the robot could stand to reach the blockade."""
        (ax, ay), (bx, by) = blockade.segment_m
        return self.floor(robot.kind).approaches(
            (ax, ay, bx, by), robot.kind.radius_m, MARGIN_M, REACH_M, self.quads()
        )

    def carrot(self, robot: Robot) -> tuple[Point, float]:
        """A point some way ahead on the robot's route, in plain reach, and the way left [m].

        Pure pursuit (Coulter, "Implementation of the Pure Pursuit Path Tracking Algorithm", 1992),
        with a look-ahead that shrinks where the straight line to it would touch a wall.
        """
        route = robot.route
        while robot.leg < len(route) - 2 and _passed(robot.position, route, robot.leg):
            robot.leg += 1
        robot.leg = _caught_up(robot.position, route, robot.leg)
        a, b = route[robot.leg], route[robot.leg + 1]
        along = nearest_on_segment(robot.position, (a, b))
        left_m = math.dist(robot.position, route[-1])
        floor, radius_m = self.floor(robot.kind), robot.kind.radius_m
        for ahead_m in (_LOOK_AHEAD_M, 0.3, 0.12):
            point = _advance(route, robot.leg, along, ahead_m)
            if floor.leg_is_clear(*robot.position, *point, radius_m + 0.01):
                return point, max(left_m, 0.0)
        return (along if math.dist(along, robot.position) > 0.05 else b), left_m


def _passed(position: Point, route: list[Point], leg: int) -> bool:
    """Whether the leg's end lies behind, or as good as reached."""
    a, b = route[leg], route[leg + 1]
    if math.dist(position, b) < _ON_ROUTE_M:
        return True
    return (position[0] - b[0]) * (b[0] - a[0]) + (position[1] - b[1]) * (b[1] - a[1]) > 0


def _caught_up(position: Point, route: list[Point], leg: int) -> int:
    """The last of the next legs that the robot stands on.

    Where a route turns back on itself, the carrot would else be where the robot is already.
    """
    along = nearest_on_segment(position, (route[leg], route[leg + 1]))
    ahead_m, last = math.dist(along, route[leg + 1]), leg
    for later in range(leg + 1, len(route) - 1):
        if ahead_m > 2.0 * _LOOK_AHEAD_M:
            break
        a, b = route[later], route[later + 1]
        if math.dist(position, nearest_on_segment(position, (a, b))) < _ON_ROUTE_M:
            last = later
        ahead_m += math.dist(a, b)
    return last


def _advance(route: list[Point], leg: int, along: Point, ahead_m: float) -> Point:
    """The point that lies so far further along the route."""
    at = along
    for end in route[leg + 1 :]:
        length = math.dist(at, end)
        if length >= ahead_m:
            ratio = ahead_m / length
            return (at[0] + ratio * (end[0] - at[0]), at[1] + ratio * (end[1] - at[1]))
        ahead_m -= length
        at = end
    return route[-1]
