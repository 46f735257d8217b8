"""A small dispatcher that speaks the service's side of the fleet protocol, for tests of the fleet.

Explorers take the nearest target that nobody else has, clearers the nearest blockade; what was
reported as blocked is tried again once something has been cleared. It plans no paths: the robots
find
their own.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any


class Dispatcher:
    """State of one mission; the simulator's `CoordinationService`."""

    def __init__(self) -> None:
        self.request: dict[str, Any] = {}
        self.reports: list[dict[str, Any]] = []
        self.unvisited: dict[str, list[float]] = {}
        self.blockades: dict[str, dict[str, Any]] = {}
        self.commands: dict[str, dict[str, Any]] = {}
        self.blocked: set[tuple[str, str]] = set()
        self.revision = 0

    retries = 0

    def create_mission(self, request: Mapping[str, Any]) -> str:
        # Through JSON, so that nothing but JSON passes.
        self.request = json.loads(json.dumps(request))
        self.unvisited = {t["id"]: t["position_m"] for t in self.request["targets"]}
        return "mission_1"

    def report(self, _: str, report: Mapping[str, Any]) -> Mapping[str, Any]:
        body = json.loads(json.dumps(report))
        self.reports.append(body)
        self.take_in(body)
        answer: dict[str, Any] = json.loads(json.dumps(self.answer(body)))
        return answer

    def take_in(self, report: dict[str, Any]) -> None:
        for blockade in report["blockades"]:
            self.blockades[blockade["id"]] = blockade
        for finished in report["finished"]:
            command = self.commands.pop(finished["robot"])
            assert command["id"] == finished["command"]
            if command["kind"] == "explore":
                self.unvisited.pop(command["location"], None)
            elif command["kind"] == "clear":
                self.blockades.pop(command["location"])
                self.blocked.clear()
        for failed in report["failed"]:
            command = self.commands.pop(failed["robot"])
            self.blocked.add((failed["robot"], command["location"]))

    def answer(self, report: dict[str, Any]) -> dict[str, Any]:
        for robot in report["robots"]:
            if robot["state"] == "failed":
                self.commands.pop(robot["id"], None)
        for robot in report["robots"]:
            if robot["id"] not in self.commands and robot["state"] != "failed":
                self.order(robot)
        return {
            "mission": {
                "id": "mission_1",
                "status": "underway" if self.unvisited else "completed",
                "revision": self.revision,
                "sequence": report["sequence"],
                "targets_left": len(self.unvisited),
                "replans": self.revision,
            },
            "commands": list(self.commands.values()),
        }

    def order(self, robot: dict[str, Any]) -> None:
        taken = {command["location"] for command in self.commands.values()}
        if robot["id"].startswith("clearer"):
            kind = "clear"
            places = {
                name: [sum(axis) / 2 for axis in zip(*b["segment_m"], strict=True)]
                for name, b in self.blockades.items()
            }
        else:
            kind, places = "explore", self.unvisited
        free = {
            name: math.dist(place, robot["pose"][:2])
            for name, place in places.items()
            if name not in taken and (robot["id"], name) not in self.blocked
        }
        if free:
            self.revision += 1
            self.commands[robot["id"]] = {
                "id": f"r{self.revision}-{robot['id']}",
                "robot": robot["id"],
                "kind": kind,
                "location": min(free, key=lambda name: (free[name], name)),
            }
