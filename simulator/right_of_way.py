"""Who lets whom pass: windowed prioritised planning among robots that would meet.

Silver, "Cooperative Pathfinding", AIIDE 2005 (WHCA*): in the order of priority each robot keeps its
motion if it meets nobody before it in the order, and otherwise plans in space and time around
them (wait, step into a niche, back off, go around). A robot that finds no such motion, for instance
in a dead end, is moved to the front of the order for a while, so that the other one has to give
way. Robots that are not on a course of collision just follow their routes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.fleet_scenario import MARGIN_M, Point
from simulator.knowledge import Knowledge
from simulator.robot import Robot, TimedPoint

_RANKS = {"clear": 0, "explore": 1, "move": 2, "dock": 3, "undock": 3}


@dataclass(frozen=True, slots=True)
class RightOfWaySettings:
    """Parameters of the negotiation."""

    period_s: float = 0.4
    """between the positions of an announced motion"""
    look_ahead_s: float = 8.0
    """how early a meeting is foreseen"""
    window_s: float = 12.0
    """how far ahead a motion that gives way is planned"""
    apart_m: float = 0.12
    """gap between two bodies that planned motions keep"""
    near_m: float = 14.0
    """robots further away are no concern"""
    front_s: float = 10.0
    """how long a robot that found no way stays at the front of the order"""
    held_s: float = 4.0
    """how long those who come are taken to be held up by a robot that cannot get away in time"""


@dataclass(frozen=True, slots=True)
class _Before:
    """The robots before one in the order: what they will do and how far to keep away."""

    robots: tuple[Robot, ...]
    apart_m: tuple[float, ...]
    """between the centres"""
    motion_of: Callable[[Robot], NDArray[np.float64]]
    """what one of them will do, (times, 2)"""

    def held(self, periods: int) -> _Before:
        """The same robots, each standing where it is for so long before it goes on."""

        def late(robot: Robot) -> NDArray[np.float64]:
            motion = self.motion_of(robot)
            return np.concatenate([np.repeat(motion[:1], periods, axis=0), motion[:-periods]])

        return _Before(self.robots, self.apart_m, late)


class RightOfWay:
    """Keeps robots from meeting; call `update` twice a second."""

    def __init__(
        self, known: Mapping[str, Knowledge], settings: RightOfWaySettings | None = None
    ) -> None:
        self.known = known
        """by robot"""
        self.settings = settings or RightOfWaySettings()
        self.plans = 0
        """motions planned to give way"""
        self.failures = 0
        """searches that found none"""
        self._front: dict[str, tuple[float, str]] = {}
        count = round(self.settings.window_s / self.settings.period_s) + 1
        self._times = np.arange(count) * self.settings.period_s
        self._looked = round(self.settings.look_ahead_s / self.settings.period_s) + 1

    def to_front(self, robot: Robot, time_s: float, because_of: str) -> None:
        """Gives a robot the first right for a while."""
        self._front[robot.id] = (time_s + self.settings.front_s, because_of)

    def update(self, robots: Sequence[Robot], time_s: float) -> None:
        """Plans motions that give way where announced motions would meet."""
        self._front = {name: f for name, f in self._front.items() if time_s < f[0]}
        for _ in range(3):
            stuck = self._negotiate(robots, time_s)
            if not stuck:
                return
            for robot, other in stuck:
                self.to_front(robot, time_s, other)

    def _negotiate(self, robots: Sequence[Robot], time_s: float) -> list[tuple[Robot, str]]:
        present = [robot for robot in robots if not robot.is_aboard]
        order = sorted(range(len(present)), key=lambda i: (self._priority(present[i], time_s), i))
        decided: dict[str, NDArray[np.float64]] = {}

        def motion_of(robot: Robot) -> NDArray[np.float64]:
            # Asked for after its turn only, when nothing changes it any more.
            if robot.id not in decided:
                decided[robot.id] = self.announced(robot, time_s)
            return decided[robot.id]

        stuck: list[tuple[Robot, str]] = []
        for place, i in enumerate(order):
            robot = present[i]
            earlier = tuple(present[k] for k in order[:place])
            gaps = (o.kind.radius_m + robot.kind.radius_m + self.settings.apart_m for o in earlier)
            before = _Before(earlier, tuple(gaps), motion_of)
            if robot.is_immovable(time_s):
                continue
            opponent = self._first_met(robot, before, time_s)
            if opponent is None:
                if not self._leaves(robot, before, present, time_s):
                    self._relieve(robot, before, time_s)
            elif not self._get_clear(robot, before, self._goals(robot, present), time_s):
                robot.timed = [(time_s, robot.x, robot.y)]
                if robot.id not in self._front:
                    stuck.append((robot, opponent.id))
        return stuck

    def _leaves(
        self, robot: Robot, before: _Before, present: Sequence[Robot], time_s: float
    ) -> bool:
        """Whether an idle robot that stood in another's way is on its way out of there.

        At the front of the order it meets nobody where it stands: the others wait for it.
        """
        if robot.goals or robot.id not in self._front or len(robot.timed) > 1:
            return False
        refuges = self._goals(robot, present)
        return bool(refuges) and self._give_way(robot, before, refuges, time_s)

    def _priority(self, robot: Robot, time_s: float) -> tuple[float, float, float]:
        if robot.is_immovable(time_s):
            return (0, 0, 0)
        if robot.id in self._front:
            return (1, self._front[robot.id][0], 0)
        if robot.command is None or robot.command_over:
            return (3, 0, 0)
        return (2, _RANKS.get(robot.command.kind, 4), 0)

    def announced(self, robot: Robot, time_s: float) -> NDArray[np.float64]:
        """Where a robot will be if nothing intervenes, (times, 2)."""
        if robot.is_immovable(time_s):
            return np.tile(np.array(robot.position), (len(self._times), 1))
        if robot.timed:
            plan = np.array(robot.timed)
            motion = np.stack(
                [np.interp(self._times + time_s, plan[:, 0], plan[:, k]) for k in (1, 2)], axis=1
            )
            motion[0] = robot.position
            return motion
        points = np.array([robot.position, *robot.route[robot.leg + 1 :]])
        lengths = np.hypot(*np.diff(points, axis=0).T) if len(points) > 1 else np.empty(0)
        travelled = np.concatenate([[0.0], np.cumsum(lengths)])
        at = self._times * robot.kind.speed_m_s
        return np.stack([np.interp(at, travelled, points[:, k]) for k in (0, 1)], axis=1)

    def _first_met(self, robot: Robot, before: _Before, time_s: float) -> Robot | None:
        """The robot that the announced motion meets first, if it meets one."""
        close = [
            (other, apart_m)
            for other, apart_m in zip(before.robots, before.apart_m, strict=True)
            if self._may_meet(robot, other, apart_m)
        ]
        if not close:
            return None
        motion = self.announced(robot, time_s)[: self._looked]
        others = np.array([before.motion_of(other)[: self._looked] for other, _ in close])
        gaps = np.linalg.norm(others - motion, axis=2)
        # Whoever is too near already meets only by coming nearer.
        near = np.minimum(0.9 * np.array([apart_m for _, apart_m in close]), gaps[:, 0] - 0.02)
        meeting = gaps < near[:, None]
        if not meeting.any():
            return None
        first = np.where(meeting.any(axis=1), meeting.argmax(axis=1), self._looked)
        return close[int(first.argmin())][0]

    def _may_meet(self, robot: Robot, other: Robot, apart_m: float) -> bool:
        """False for robots whose routes cannot bring them together within the look-ahead."""
        if robot.timed or other.timed:
            return True
        together_m_s = robot.kind.speed_m_s + other.kind.speed_m_s
        reach_m = apart_m + self.settings.look_ahead_s * together_m_s
        return math.dist(robot.position, other.position) <= reach_m

    def _relieve(self, robot: Robot, before: _Before, time_s: float) -> None:
        """Back to a plain route once that meets nobody any more."""
        if not robot.timed or (time_s - robot.timed[0][0]) % 2.0 < 1.5:
            return
        if not robot.goals:
            if time_s > robot.timed[-1][0]:
                robot.timed = []
            return
        kept = robot.timed
        route = self.known[robot.id].navigation.route(robot, robot.goals)
        if route is not None:
            robot.follow(route)
            if self._first_met(robot, before, time_s) is not None:
                robot.timed = kept

    def _goals(self, robot: Robot, others: Sequence[Robot]) -> list[Point]:
        """Where the robot wants to go; an idle one at the front wants out of the other's way."""
        if robot.goals or robot.id not in self._front:
            return robot.goals
        other = next((r for r in others if r.id == self._front[robot.id][1]), None)
        if other is None:
            return []
        way = [other.position, *other.route[other.leg + 1 :]]
        navigation = self.known[robot.id].navigation
        return navigation.floor(robot.kind).refuges(
            robot.position,
            way if len(way) > 1 else [*way, *way],
            robot.kind.radius_m + other.kind.radius_m + 0.2,
            5,
            robot.kind.radius_m,
            MARGIN_M,
            navigation.quads(),
            navigation.standing_but(robot),
        )

    def _get_clear(self, robot: Robot, before: _Before, goals: list[Point], time_s: float) -> bool:
        """Gives way; where the others are too near for that, gets out of the way they wait for.

        Those who come brake before a robot that stands there, so there is time to leave.
        """
        if self._give_way(robot, before, goals, time_s):
            return True
        held = round(self.settings.held_s / self.settings.period_s)
        if not self._give_way(robot, before.held(held), goals, time_s):
            return False
        robot.timed = _at_once(robot.timed)
        return True

    def _give_way(self, robot: Robot, before: _Before, goals: list[Point], time_s: float) -> bool:
        """Plans a motion around those before; False if there is none."""
        self.plans += 1
        motions = [
            ([(x, y) for x, y in before.motion_of(other).tolist()], gap)
            for other, gap in zip(before.robots, before.apart_m, strict=True)
            if math.dist(other.position, robot.position) < self.settings.near_m
        ]
        navigation = self.known[robot.id].navigation
        plan = navigation.floor(robot.kind).timed_route(
            robot.position,
            goals,
            motions,
            0.9 * robot.kind.speed_m_s,
            self.settings.period_s,
            self.settings.window_s,
            robot.kind.radius_m,
            MARGIN_M,
            navigation.quads(),
            navigation.standing_but(robot),
        )
        if plan is None:
            self.failures += 1
            return False
        robot.timed = [(time_s + t, x, y) for t, x, y in plan]
        return True


def _at_once(plan: list[TimedPoint], within_m: float = 0.15) -> list[TimedPoint]:
    """The motion without the wait at its beginning: nobody moves before this robot has left."""
    start = plan[0]
    for index, point in enumerate(plan):
        if math.dist(point[1:], start[1:]) > within_m:
            early_s = plan[max(index - 1, 0)][0] - start[0]
            return [start, *((t - early_s, x, y) for t, x, y in plan[index:])]
    return plan
