"""A fleet without physics: robots glide along their commands' paths, blockades turn up by the
clock.

It costs next to nothing, so that what is measured is the service.
"""

import base64
import random
import zlib
from dataclasses import dataclass, field
from functools import cache
from math import hypot
from typing import Any

WIDTH, HEIGHT, RESOLUTION_M = 120, 80, 0.5
ROOM = 20
"""Rooms are squares of this many cells, with a door in the middle of each wall."""
EXPLORERS, CLEARERS, TARGETS = 3, 2, 10
BLOCKADE_EVERY_S = 15.0
Point = tuple[float, float]


@cache
def map_message() -> dict[str, Any]:
    """A floor of square rooms, each with doors to its neighbours."""
    cells = bytearray(WIDTH * HEIGHT)
    for row in range(HEIGHT):
        for column in range(WIDTH):
            edge = row in (0, HEIGHT - 1) or column in (0, WIDTH - 1)
            wall = row % ROOM == 0 or column % ROOM == 0
            door = ROOM // 2 - 2 <= (row if column % ROOM == 0 else column) % ROOM <= ROOM // 2 + 2
            cells[row * WIDTH + column] = 100 if edge or (wall and not door) else 0
    return {
        "resolution_m": RESOLUTION_M,
        "origin_m": [0.0, 0.0],
        "width": WIDTH,
        "height": HEIGHT,
        "encoding": "zlib+base64",
        "cells": base64.b64encode(zlib.compress(bytes(cells))).decode(),
    }


@dataclass
class Glider:
    """A robot that drives 1 m/s."""

    id: str
    type: str
    position: Point
    command: dict[str, Any] | None = None
    path: list[Point] = field(default_factory=list)
    busy_until_s: float | None = None


class GlidingFleet:
    """Three explorers and two clearers with ten targets."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        types = ["explorer"] * EXPLORERS + ["clearer"] * CLEARERS
        self.robots = [
            Glider(f"{kind}_{number}", kind, self._in_a_room())
            for number, kind in enumerate(types, 1)
        ]
        self.targets = [self._in_a_room() for _ in range(TARGETS)]
        self.time_s = 0.0
        self.sequence = 0
        self._finished: list[dict[str, str]] = []
        self._next_blockade_s = BLOCKADE_EVERY_S
        self._blockades = 0

    def _in_a_room(self) -> Point:
        """A place away from all walls."""
        room_m = ROOM * RESOLUTION_M
        column = self._random.randrange(WIDTH // ROOM)
        row = self._random.randrange(HEIGHT // ROOM)
        return (
            column * room_m + self._random.uniform(2.0, room_m - 2.0),
            row * room_m + self._random.uniform(2.0, room_m - 2.0),
        )

    def mission(self, name: str, fleet: str) -> dict[str, Any]:
        """The body that creates the mission."""
        kind = {"radius_m": 0.3, "speed_m_s": 1.0, "sensor_range_m": 5.0}
        return {
            "name": name,
            "fleet": fleet,
            "domain": "disaster",
            "map": map_message(),
            "robot_types": {"explorer": kind, "clearer": kind},
            "robots": [
                {"id": robot.id, "type": robot.type, "pose": [*robot.position, 0.0]}
                for robot in self.robots
            ],
            "targets": [
                {"id": f"target_{number}", "position_m": list(position)}
                for number, position in enumerate(self.targets, 1)
            ],
        }

    def report(self) -> tuple[dict[str, Any], bool]:
        """The next report, and whether it holds a fact that asks for new commands."""
        blockades = []
        if self.time_s >= self._next_blockade_s:
            self._next_blockade_s += BLOCKADE_EVERY_S
            blockades.append(self._blockade())
        body = {
            "sequence": self.sequence,
            "time_s": self.time_s,
            "robots": [
                {
                    "id": robot.id,
                    "pose": [*robot.position, 0.0],
                    "state": "clearing"
                    if robot.busy_until_s
                    else "driving"
                    if robot.path
                    else "idle",
                    "command": robot.command["id"] if robot.command else None,
                    "busy_until_s": robot.busy_until_s,
                }
                for robot in self.robots
            ],
            "blockades": blockades,
            "finished": self._finished,
        }
        fact = bool(blockades or self._finished)
        self._finished = []
        self.sequence += 1
        return body, fact

    def _blockade(self) -> dict[str, Any]:
        """A doorway that is found to be blocked."""
        self._blockades += 1
        room_m = ROOM * RESOLUTION_M
        x = self._random.randrange(1, WIDTH // ROOM) * room_m + RESOLUTION_M / 2
        y = (self._random.randrange(HEIGHT // ROOM) + 0.5) * room_m
        return {
            "id": f"blockade_{self._blockades}",
            "segment_m": [[x, y - 1.0], [x, y + 1.5]],
            "clear_duration_s": 10.0,
        }

    def obey(self, commands: list[dict[str, Any]]) -> None:
        """Takes over the commands of an answer; one that goes on is left alone."""
        by_robot = {command["robot"]: command for command in commands}
        for robot in self.robots:
            command = by_robot.get(robot.id)
            if robot.busy_until_s is not None or (command and command == robot.command):
                continue
            if robot.command and command and robot.command["id"] == command["id"]:
                continue
            robot.command = command
            robot.path = [(x, y) for x, y in command["path_m"]] if command else []
            if command and command["kind"] == "clear":
                robot.busy_until_s = self.time_s + 10.0

    def advance(self, duration_s: float) -> None:
        """Lets time pass."""
        self.time_s += duration_s
        for robot in self.robots:
            if robot.busy_until_s is not None:
                if self.time_s >= robot.busy_until_s:
                    robot.busy_until_s = None
                    self._finish(robot)
            elif robot.path:
                self._glide(robot, duration_s)

    def _glide(self, robot: Glider, budget_m: float) -> None:
        while robot.path and budget_m > 0.0:
            x, y = robot.position
            goal_x, goal_y = robot.path[0]
            length = hypot(goal_x - x, goal_y - y)
            if length <= budget_m:
                robot.position = robot.path.pop(0)
                budget_m -= length
            else:
                share = budget_m / length
                robot.position = (x + (goal_x - x) * share, y + (goal_y - y) * share)
                return
        self._finish(robot)

    def _finish(self, robot: Glider) -> None:
        if robot.command is not None:
            self._finished.append({"robot": robot.id, "command": robot.command["id"]})
        robot.command, robot.path = None, []
