"""What a fleet tells the service of what it knows, and the orders that come back."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping

from simulator.contact import Contact
from simulator.execution import Execution
from simulator.fleet_client import FleetClient, MissionState
from simulator.fleet_scenario import FleetScenario
from simulator.knowledge import Ending, Order
from simulator.robot import Robot

_AT_ONCE_S = 1.0
"""what was told as soon as that was not kept from the service by the lack of a radio"""


class Reporting:
    """The robots in contact with the service report and are given orders; others are not heard."""

    def __init__(
        self,
        scenario: FleetScenario,
        client: FleetClient,
        contact: Contact,
        robots: Mapping[str, Robot],
    ) -> None:
        self.client = client
        self.contact = contact
        self.robots = robots
        self.waited_s = 0.0
        """spent waiting for answers [wall clock]"""
        self.reports = 0
        self.reported_s = -math.inf
        """when the last report was sent"""
        self._blockades = {blockade.id: blockade for blockade in scenario.blockades}
        self._period_s = scenario.report_period_s

    def is_due(self, time_s: float) -> bool:
        """Whether there is news, or the last report was long ago."""
        return self.contact.base.has_news or time_s - self.reported_s >= self._period_s

    def report(self, execution: Execution, time_s: float) -> MissionState:
        """Tells what is known where the service hears it; its orders are obeyed there at once.

        Raises:
            FleetClientError: the service is out of reach or refuses.
        """
        known = self.contact.base
        patches = [] if known.sensed_map is None else known.sensed_map.news()
        if patches:
            known.study_map()
        heard = self.contact.linked | known.dead.keys()
        begin_s = time.perf_counter()
        number = self.client.sequence
        answer = self.client.report(
            round(time_s, 3),
            [_robot_report(robot) for robot in self.robots.values() if robot.id in heard],
            [self._blockade_report(name) for name in known.untold],
            [_ending(e, time_s) for e in known.endings if e.reason is None],
            [
                {**_ending(e, time_s), "reason": e.reason}
                for e in known.endings
                if e.reason is not None
            ],
            map_patches=patches,
        )
        self.waited_s += time.perf_counter() - begin_s
        known.tell()
        self.reports += 1
        self.reported_s = time_s
        known.orders = {
            command.robot: Order(number, command)
            for command in answer.commands
            if command.robot in self.robots
        }
        for name in self.robots:
            known.orders.setdefault(name, Order(number, None))
        execution.assign(self.contact.groups.of_base, time_s)
        return answer.mission

    def _blockade_report(self, name: str) -> dict[str, object]:
        blockade = self._blockades[name]
        return {
            "id": name,
            "segment_m": [list(end) for end in blockade.segment_m],
            "clear_duration_s": blockade.clear_duration_s,
        }


def _ending(ending: Ending, time_s: float) -> dict[str, object]:
    """A command that is over; when and where is said if the service could not be told at once."""
    told: dict[str, object] = {"robot": ending.robot, "command": ending.command}
    if time_s - ending.time_s > _AT_ONCE_S:
        told["time_s"] = round(ending.time_s, 3)
        told["position_m"] = [round(axis, 4) for axis in ending.position_m]
    return told


def _robot_report(robot: Robot) -> dict[str, object]:
    report: dict[str, object] = {
        "id": robot.id,
        "pose": [round(robot.x, 4), round(robot.y, 4), round(robot.heading_rad, 4)],
        "state": robot.activity,
    }
    if robot.command is not None:
        report["command"] = robot.command.id
    if robot.is_busy:
        report["busy_until_s"] = round(robot.busy_until_s, 3)
    return report
