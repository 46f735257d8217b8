"""Velocities for the next step, and a guard that brakes before anything is touched."""

from __future__ import annotations

import bisect
import math
from collections.abc import Mapping, Sequence

import numpy as np

from simulator._core import Floor
from simulator.fleet_scenario import MARGIN_M, Point
from simulator.knowledge import Knowledge
from simulator.robot import Robot, steer
from simulator.segment_geometry import nearest_on_segment
from simulator.world import World

_GAP_M = 0.03
"""the guard's distance to robots and blockades"""
_STAND_OFF_M = 0.25
"""its distance to a robot straight ahead, which leaves that one room to turn aside"""
_BESIDE_M = _STAND_OFF_M + 0.05
"""a robot no further away than that may be the one that holds another"""
_WALL_GAP_M = 0.005
_PATIENCE_S = 0.5
"""how long a robot that the guard holds insists on its course before it turns aside"""
_LONGEST_HELD_S = 2.0
_RELIEF = 2.0
"""how much faster than that it forgets, once it drives"""
_FEW = 10
"""robots; for more of them arrays are quicker than loops"""
_AHEAD_S = 0.5
"""how far ahead of its plan a robot that gives way steers"""


class Driving:
    """Drives all robots of a world for one step at a time."""

    def __init__(
        self, world: World, known: Mapping[str, Knowledge], walls: Floor | None = None
    ) -> None:
        self.world = world
        self.walls = walls
        """the true ones, which the lasers of robots see that do not know where they are exactly"""
        self.known = known
        """by robot"""

    def drive(self, robots: Sequence[Robot], time_s: float, step_s: float) -> None:
        """Sets every body's velocity; brakes are ideal, so a safe next position is enough."""
        present = [robot for robot in robots if not robot.is_aboard]
        near = _neighbours(present)
        ahead: dict[str, Point] = {robot.id: robot.truth[:2] for robot in present}
        for i, robot in enumerate(present):
            wish = None if robot.is_immovable(time_s) else self._wish(robot, time_s)
            if wish is None:
                robot.stalled_s = robot.held_s = 0.0
                self.world.drive(robot.id, (0.0, 0.0), 0.0)
                continue
            towards, limit_m_s = wish
            if robot.held_s > _PATIENCE_S and robot.kind.drive != "ackermann":
                towards = self._aside(robot, towards, near[i])
            speed, turn = steer(robot, towards, limit_m_s, step_s)
            x, y, heading_rad = robot.truth
            course = heading_rad + 0.5 * turn * step_s
            direction = (math.cos(course), math.sin(course))
            share = self._safe_share(robot, direction, speed * step_s, near[i], ahead)
            speed *= share
            if robot.kind.drive == "ackermann":
                turn *= share
            velocity = (speed * direction[0], speed * direction[1])
            ahead[robot.id] = (x + velocity[0] * step_s, y + velocity[1] * step_s)
            if speed != 0.0:
                robot.held_s = max(0.0, robot.held_s - _RELIEF * step_s)
            else:
                robot.held_s = min(_LONGEST_HELD_S, robot.held_s + step_s)
            moves = abs(speed) > 0.02 * robot.kind.speed_m_s or abs(turn) > 0.2
            robot.stalled_s = 0.0 if moves else robot.stalled_s + step_s
            self.world.drive(robot.id, velocity, turn)

    def leave_wall(self, robot: Robot, present: Sequence[Robot], time_s: float) -> bool:
        """Sends a robot that nothing but a wall holds to the roomiest place close by.

        A route begins where the robot stands, and so may pass a wall's end closer than the guard
        lets it drive. From a roomier place the next route is a wider one.

        Returns:
            Whether the robot is on its way there.
        """
        radius_m = robot.kind.radius_m
        if any(
            math.dist(other.position, robot.position) < radius_m + other.kind.radius_m + _BESIDE_M
            for other in present
            if other is not robot
        ):
            return False
        floor = self.known[robot.id].navigation.floor(robot.kind)
        limit_m = radius_m + MARGIN_M
        if floor.clearance(*robot.position, limit_m) >= limit_m:
            return False
        place = self._away_from_walls(robot)
        if place is None:
            return False
        robot.timed = [(time_s, *robot.position), (time_s + 1.0, *place)]
        return True

    def _wish(self, robot: Robot, time_s: float) -> tuple[Point, float] | None:
        """The point to steer to and the speed limit on the way, or None to stand still."""
        if robot.timed:
            return self._timed_carrot(robot, time_s)
        if len(robot.route) < 2:
            return None
        towards, left_m = self.known[robot.id].navigation.carrot(robot)
        return (towards, 5.0 * left_m) if left_m > 0.03 else None

    def _timed_carrot(self, robot: Robot, time_s: float) -> tuple[Point, float] | None:
        plan = robot.timed
        last = bisect.bisect_right(plan, time_s + _AHEAD_S, key=lambda p: p[0]) - 1
        floor, radius_m = self.known[robot.id].navigation.floor(robot.kind), robot.kind.radius_m
        points = [(x, y) for _, x, y in plan[max(last - 12, 0) : max(last, 0) + 1]]
        reachable = (
            point
            for margin_m in (0.01, _WALL_GAP_M + 0.001)
            for point in reversed(points)
            if floor.leg_is_clear(*robot.position, *point, radius_m + margin_m)
        )
        point = next(reachable, None)
        if point is None and len(plan) > 1:
            point = self._away_from_walls(robot)
        if point is None:
            return None
        left_m = math.dist(robot.position, point)
        # As fast as the plan, so that the robot arrives neither early nor late.
        return (point, 1.1 * left_m / _AHEAD_S) if left_m > 0.05 else None

    def _away_from_walls(self, robot: Robot, far_m: float = 0.1) -> Point | None:
        """The roomiest place close by, for a robot whose guard lets it go no nearer to a wall."""
        floor, limit_m = (
            self.known[robot.id].navigation.floor(robot.kind),
            robot.kind.radius_m + far_m,
        )
        angles = [k * math.tau / 16 for k in range(16)]
        around = [
            (robot.x + far_m * math.cos(angle), robot.y + far_m * math.sin(angle))
            for angle in angles
        ]
        free = [place for place in around if not floor.is_forbidden(*place)]
        if not free or floor.clearance(*robot.position, limit_m) >= limit_m:
            return None
        return max(free, key=lambda place: floor.clearance(place[0], place[1], limit_m))

    def _aside(self, robot: Robot, towards: Point, near: Sequence[Robot]) -> Point:
        """Where a robot steers to that the guard lets go no further on its course."""
        other = min(near, key=lambda o: math.dist(o.position, robot.position), default=None)
        if other is not None:
            reach_m = robot.kind.radius_m + other.kind.radius_m + _BESIDE_M
            to = (other.x - robot.x, other.y - robot.y)
            if math.hypot(*to) <= reach_m:
                return self._past(robot, towards, to)
        # The course cut the corner at the end of a blockade.
        here = robot.truth[:2]
        reach_m = robot.kind.radius_m + 2.0 * _GAP_M
        points = [
            nearest_on_segment(here, blockade.segment_m)
            for blockade in self.world.blockades_near(here, reach_m)
        ]
        nearest = min(points, key=lambda point: math.dist(point, here), default=None)
        if nearest is None or math.dist(nearest, here) > reach_m:
            return towards
        return self._past(robot, towards, (nearest[0] - here[0], nearest[1] - here[1]))

    @staticmethod
    def _past(robot: Robot, towards: Point, to: Point) -> Point:
        """Where to steer to get past what is close by in the way: along its side.

        Of two robots that meet head-on each turns to its right. The course leads a little away from
        the obstacle, so that the guard lets the robot pass.

        Args:
            to: from the robot to the obstacle [m].
        """
        wish = (towards[0] - robot.x, towards[1] - robot.y)
        far_m = math.hypot(*to)
        along = (wish[0] * to[0] + wish[1] * to[1]) / max(far_m * math.hypot(*wish), 1e-9)
        if along <= 0.0:
            return towards
        ahead = (to[0] / far_m, to[1] / far_m)
        side = (ahead[1], -ahead[0])
        if along < 0.9 and wish[0] * side[0] + wish[1] * side[1] < 0.0:
            side = (-side[0], -side[1])
        return (
            robot.x + 0.3 * (side[0] - 0.15 * ahead[0]),
            robot.y + 0.3 * (side[1] - 0.15 * ahead[1]),
        )

    def _safe_share(
        self,
        robot: Robot,
        direction: Point,
        far_m: float,
        near: Sequence[Robot],
        ahead: dict[str, Point],
    ) -> float:
        """The greatest of some shares of a step whose end touches nothing."""
        here = robot.truth[:2]
        for share in (1.0, 0.5, 0.2):
            step_m = share * far_m
            after = (here[0] + step_m * direction[0], here[1] + step_m * direction[1])
            if self._is_safe(robot, here, after, near, ahead):
                return share
        return 0.0

    def _is_safe(
        self,
        robot: Robot,
        here: Point,
        after: Point,
        near: Sequence[Robot],
        ahead: dict[str, Point],
    ) -> bool:
        radius_m = robot.kind.radius_m
        floor = self.known[robot.id].navigation.floor(robot.kind)
        limit_m = radius_m + _WALL_GAP_M
        walls = floor if robot.body is None or self.walls is None else self.walls
        room = walls.clearance(*after, limit_m)
        if room < limit_m and room < walls.clearance(*here, limit_m):
            return False
        if floor.is_forbidden(*after) and not floor.is_forbidden(*here):
            return False
        for other in near:
            gap = math.dist(after, ahead[other.id])
            before = math.dist(here, ahead[other.id])
            apart_m = radius_m + other.kind.radius_m + self._gap_m(robot, other, here, after)
            if gap < apart_m and gap < before:
                return False
        for blockade in self.world.blockades_near(after, radius_m + _GAP_M):
            gap = math.dist(after, nearest_on_segment(after, blockade.segment_m))
            if gap < radius_m + _GAP_M and gap < math.dist(
                here, nearest_on_segment(here, blockade.segment_m)
            ):
                return False
        return True

    @staticmethod
    def _gap_m(robot: Robot, other: Robot, here: Point, after: Point) -> float:
        meets = robot.command is not None and robot.command.partner == other.id
        if robot.timed or meets:
            return _GAP_M
        x, y, _ = other.truth
        step = (after[0] - here[0], after[1] - here[1])
        towards = (x - here[0], y - here[1])
        along = step[0] * towards[0] + step[1] * towards[1]
        straight = along > 0.8 * math.hypot(*step) * math.hypot(*towards)
        return _STAND_OFF_M if straight else _GAP_M


def _neighbours(present: Sequence[Robot], within_m: float = 2.5) -> list[list[Robot]]:
    """For each robot those close to it."""
    near: list[list[Robot]] = [[] for _ in present]
    if len(present) > _FEW:
        at = np.array([(robot.x, robot.y) for robot in present])
        apart = np.abs(at[:, None, :] - at[None, :, :]).max(axis=2)
        np.fill_diagonal(apart, np.inf)
        for i, j in np.argwhere(apart < within_m).tolist():
            near[i].append(present[j])
        return near
    for i, robot in enumerate(present):
        for other in present:
            if (
                abs(robot.x - other.x) < within_m
                and abs(robot.y - other.y) < within_m
                and other is not robot
            ):
                near[i].append(other)
    return near
