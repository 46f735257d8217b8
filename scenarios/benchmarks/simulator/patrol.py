"""A service that only sends robots from place to place, so that the simulator alone is measured."""

from __future__ import annotations

import random
from collections.abc import Mapping
from typing import Any


class Patrol:
    """Answers the fleet protocol: every idle robot is sent to a random target, for ever."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.places: list[str] = []
        self.commands: dict[str, dict[str, Any]] = {}
        self.issued = 0

    @property
    def retries(self) -> int:
        """It answers at once, always."""
        return 0

    def create_mission(self, request: Mapping[str, Any]) -> str:
        """Notes where to go."""
        self.places = [target["id"] for target in request["targets"]]
        return "patrol"

    def report(self, _: str, report: Mapping[str, Any]) -> Mapping[str, Any]:
        """A command for every robot."""
        for ended in (*report["finished"], *report["failed"]):
            self.commands.pop(ended["robot"], None)
        for robot in report["robots"]:
            if robot["id"] not in self.commands:
                self.issued += 1
                self.commands[robot["id"]] = {
                    "id": f"p{self.issued}",
                    "robot": robot["id"],
                    "kind": "move",
                    "location": self.random.choice(self.places),
                }
        state = {
            "status": "underway",
            "revision": self.issued,
            "targets_left": len(self.places),
            "replans": 0,
        }
        commands = list(self.commands.values())
        return {"mission": state, "commands": commands}
