"""Robots that are out of touch with the service and have nothing left to do come back to it.

Otherwise a mission would starve: the service waits for news that nobody brings. A robot goes to
where it last was in contact; if it is not there, because others passed the word on and have left,
it goes on towards the base station.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from simulator.contact import Contact
from simulator.execution import ARRIVED_M, Execution
from simulator.robot import Robot

_PATIENCE_S = 60.0
"""how long a robot out of contact waits for others, for instance to dock, before it gives up"""
_TRIES_AGAIN_S = 10.0
"""when a robot that found no way back looks again"""


class Homing:
    """Sends idle robots that nobody can order about back into contact."""

    def __init__(self, contact: Contact, execution: Execution) -> None:
        self.contact = contact
        self.execution = execution
        self._home: set[str] = set()
        """robots that come back of their own accord"""
        self._waits_since_s: dict[str, float] = {}
        self._tried_s: dict[str, float] = {}

    def update(self, robots: Iterable[Robot], time_s: float) -> None:
        """Looks once a second or so who has to come back, and stops those who are in contact."""
        if self.contact.radio is None:
            return
        for robot in robots:
            if robot.id in self._home and (
                robot.id in self.contact.linked or not robot.command_over
            ):
                self._home.discard(robot.id)
                if robot.command_over and not robot.is_immovable(time_s):
                    robot.stop()
                    robot.activity = "idle"
            if robot.id in self.contact.linked or robot.has_failed:
                self._waits_since_s.pop(robot.id, None)
            elif not robot.command_over:
                self._lose_patience(robot, time_s)
            elif robot.is_aboard:
                self.execution.follow_up(robot, time_s)
            elif not robot.is_immovable(time_s):
                self._come_back(robot, time_s)

    def _lose_patience(self, robot: Robot, time_s: float) -> None:
        if robot.is_busy or robot.stalled_s > 0.0 or self._moves(robot):
            self._waits_since_s.pop(robot.id, None)
            return
        since_s = self._waits_since_s.setdefault(robot.id, time_s)
        if time_s - since_s > _PATIENCE_S:
            self._waits_since_s.pop(robot.id)
            self.execution.give_up(robot, time_s, "nobody came, and nobody is in contact")

    @staticmethod
    def _moves(robot: Robot) -> bool:
        if len(robot.route) < 2:
            return False
        return math.dist(robot.position, robot.route[-1]) > ARRIVED_M

    def _come_back(self, robot: Robot, time_s: float) -> None:
        radio = self.contact.radio
        if self.execution.follow_up(robot, time_s):
            self._home.discard(robot.id)
            return
        if radio is None or self._moves(robot) or robot.timed:
            return
        if time_s - self._tried_s.get(robot.id, -math.inf) < _TRIES_AGAIN_S:
            return
        places = [self.contact.last_linked_m[robot.id], radio.base_m]
        if math.dist(robot.position, places[0]) <= 2 * ARRIVED_M:
            places.pop(0)
        navigation = self.contact[robot.id].navigation
        for place in places:
            route = navigation.route(robot, [place])
            if route is not None:
                self._home.add(robot.id)
                robot.stop()
                robot.goals = [place]
                robot.follow(route)
                robot.activity = "driving"
                return
        self._tried_s[robot.id] = time_s
