"""A service that only sends robots from place to place, so that the simulator alone is measured."""

from __future__ import annotations

import json
import random
from typing import Any

import httpx


class Patrol:
    """Answers the fleet protocol: every idle robot is sent to a random target, for ever."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.places: list[str] = []
        self.commands: dict[str, dict[str, Any]] = {}
        self.issued = 0

    def client(self) -> httpx.Client:
        """A client whose requests this object answers in the same thread."""
        return httpx.Client(transport=httpx.MockTransport(self.answer), base_url="http://patrol")

    def answer(self, request: httpx.Request) -> httpx.Response:
        """One request of the protocol."""
        body = json.loads(request.content)
        if request.url.path.endswith("/missions"):
            self.places = [target["id"] for target in body["targets"]]
            return httpx.Response(201, json={"id": "patrol"})
        for ended in (*body["finished"], *body["failed"]):
            self.commands.pop(ended["robot"], None)
        for robot in body["robots"]:
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
        return httpx.Response(200, json={"mission": state, "commands": commands})
