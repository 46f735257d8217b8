"""A fleet in plain geometry: robots glide along their paths, blockades hide until one is near.

No physics and no service code: it knows the protocol and nothing else.
"""

import base64
import zlib
from dataclasses import dataclass, field
from math import hypot
from typing import Any

import numpy as np

Point = tuple[float, float]


def walls(rows: list[str]) -> list[list[int]]:
    """Occupancy from a drawing, `#` being a wall; the last line is the bottom row."""
    return [[100 if cell == "#" else 0 for cell in row] for row in reversed(rows)]


def map_json(cells: list[list[int]], resolution_m: float = 1.0) -> dict[str, Any]:
    """Cells in the encoding of the protocol."""
    grid = np.array(cells, dtype=np.int8)
    return {
        "resolution_m": resolution_m,
        "origin_m": [0.0, 0.0],
        "width": grid.shape[1],
        "height": grid.shape[0],
        "encoding": "zlib+base64",
        "cells": base64.b64encode(zlib.compress(grid.tobytes())).decode(),
    }


@dataclass
class Robot:
    """A robot that drives 1 m/s."""

    id: str
    type: str
    position: Point
    state: str = "idle"
    command: dict[str, Any] | None = None
    path: list[Point] = field(default_factory=list)
    busy_until_s: float | None = None
    carrier: str | None = None

    @property
    def is_busy(self) -> bool:
        return self.state in ("clearing", "docking", "undocking")


@dataclass
class HiddenBlockade:
    """A blockade that is in the world from the start."""

    id: str
    segment: tuple[Point, Point]
    clear_duration_s: float = 10.0
    cleared: bool = False


@dataclass
class ScriptedFleet:
    """Steps of `step_s` seconds; `report()` and `obey()` speak the protocol."""

    robots: list[Robot]
    blockades: list[HiddenBlockade] = field(default_factory=list)
    step_s: float = 1.0
    sensor_range_m: float = 4.0
    stop_m: float = 0.8
    dock_duration_s: float = 5.0
    time_s: float = 0.0
    sequence: int = 0
    seen: list[HiddenBlockade] = field(default_factory=list)
    told: set[str] = field(default_factory=set)
    finished: list[dict[str, str]] = field(default_factory=list)
    done: set[str] = field(default_factory=set)
    """Ids of commands carried out: none is carried out again, should an answer still carry it."""
    executed: list[tuple[str, str, str | None]] = field(default_factory=list)
    """Every command carried out: robot, kind, location."""

    def mission(self, cells: list[list[int]], targets: list[Point], **more: Any) -> dict[str, Any]:
        """The body that creates the mission."""
        kind = {
            "radius_m": 0.3,
            "speed_m_s": 1.0,
            "sensor_range_m": self.sensor_range_m,
            "enters": ["default"],
        }
        return {
            "name": "scripted",
            "domain": "disaster",
            "strategy": "hungarian",
            "map": map_json(cells),
            "robot_types": {"explorer": kind, "clearer": kind},
            "robots": [
                {"id": r.id, "type": r.type, "pose": [*r.position, 0.0]} for r in self.robots
            ],
            "targets": [
                {"id": f"target_{index}", "position_m": list(position)}
                for index, position in enumerate(targets, 1)
            ],
            **more,
        }

    def report(self) -> dict[str, Any]:
        """The next report; facts in it are told once."""
        body = {
            "sequence": self.sequence,
            "time_s": self.time_s,
            "robots": [
                {
                    "id": robot.id,
                    "pose": [*robot.position, 0.0],
                    "state": robot.state,
                    "command": robot.command["id"] if robot.command else None,
                    "busy_until_s": robot.busy_until_s,
                }
                for robot in self.robots
            ],
            "blockades": [
                {
                    "id": blockade.id,
                    "segment_m": [list(end) for end in blockade.segment],
                    "clear_duration_s": blockade.clear_duration_s,
                }
                for blockade in self.seen
            ],
            "finished": self.finished,
        }
        self.sequence += 1
        self.seen, self.finished = [], []
        return body

    def obey(self, answer: dict[str, Any]) -> None:
        """Takes over the commands of an answer; a command that goes on is left alone."""
        commands = {command["robot"]: command for command in answer["commands"]}
        for robot in self.robots:
            command = commands.get(robot.id)
            if robot.is_busy or robot.state == "failed":
                continue
            if command is None or command["id"] in self.done:
                robot.command, robot.path = None, []
                robot.state = "docked" if robot.carrier else "idle"
            elif robot.command is None or robot.command["id"] != command["id"]:
                self._begin(robot, command)

    def _begin(self, robot: Robot, command: dict[str, Any]) -> None:
        robot.command = command
        robot.path = [(x, y) for x, y in command["path_m"]]
        robot.state = "driving" if robot.path else "docked" if robot.carrier else "idle"
        if command["kind"] == "clear":
            blockade = self._blockade(command["location"])
            robot.state = "clearing"
            robot.busy_until_s = self.time_s + blockade.clear_duration_s
        elif command["kind"] in ("dock", "undock"):
            robot.state = command["kind"] + "ing"
            robot.busy_until_s = self.time_s + self.dock_duration_s

    def _blockade(self, identifier: str) -> HiddenBlockade:
        return next(blockade for blockade in self.blockades if blockade.id == identifier)

    def step(self) -> None:
        """Lets `step_s` seconds pass."""
        self.time_s += self.step_s
        for robot in self.robots:
            if robot.is_busy:
                if self.time_s >= (robot.busy_until_s or 0.0):
                    self._end_activity(robot)
            elif robot.path:
                self._drive(robot, self.step_s)
            for blockade in self.blockades:
                known = blockade.cleared or blockade.id in self.told
                if not known and distance(robot.position, blockade.segment) <= self.sensor_range_m:
                    self.seen.append(blockade)
                    self.told.add(blockade.id)

    def _end_activity(self, robot: Robot) -> None:
        assert robot.command is not None
        kind, partner = robot.command["kind"], robot.command["partner"]
        if kind == "clear":
            self._blockade(robot.command["location"]).cleared = True
        elif robot.type == "rover":
            carrier = next(other for other in self.robots if other.id == partner)
            assert distance(robot.position, (carrier.position, carrier.position)) < 3.0
            robot.position = carrier.position
            robot.carrier = partner if kind == "dock" else None
        self._finish(robot)

    def _drive(self, robot: Robot, budget_m: float) -> None:
        assert robot.command is not None
        while robot.path and budget_m > 0:
            x, y = robot.position
            goal_x, goal_y = robot.path[0]
            length = hypot(goal_x - x, goal_y - y)
            if length <= 1e-9:
                robot.path.pop(0)
                continue
            move = min(budget_m, length, 0.1)
            position = (x + (goal_x - x) * move / length, y + (goal_y - y) * move / length)
            for blockade in self.blockades:
                nearer = distance(position, blockade.segment) < distance(
                    robot.position, blockade.segment
                )
                if (
                    not blockade.cleared
                    and nearer
                    and distance(position, blockade.segment) < self.stop_m
                ):
                    if robot.command["location"] == blockade.id:
                        self._finish(robot)
                    robot.path = []
                    return
            robot.position = position
            for rider in self.robots:
                if rider.carrier == robot.id:
                    rider.position = position
            budget_m -= move
        if not robot.path:
            self._finish(robot)

    def _finish(self, robot: Robot) -> None:
        assert robot.command is not None
        self.finished.append({"robot": robot.id, "command": robot.command["id"]})
        self.done.add(robot.command["id"])
        self.executed.append((robot.id, robot.command["kind"], robot.command["location"]))
        robot.command, robot.path = None, []
        robot.state = "docked" if robot.carrier else "idle"
        robot.busy_until_s = None


def distance(point: Point, segment: tuple[Point, Point]) -> float:
    """Distance of a point to a segment."""
    p, a, b = (np.array(value) for value in (point, *segment))
    share = np.clip((p - a) @ (b - a) / max(float((b - a) @ (b - a)), 1e-12), 0.0, 1.0)
    return float(np.linalg.norm(a + share * (b - a) - p))
