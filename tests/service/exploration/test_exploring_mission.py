"""A mission in an unknown map: frontiers become targets, and the mission ends without any."""

from pathlib import Path

import numpy as np
from httpx import Response
from in_process import InProcessClient, serving

from service.app import create_app
from service.coordination.known_map import write_cells
from service.settings import Settings

HALL = np.full((12, 40), 100, dtype=np.int8)
HALL[1:-1, 1:-1] = 0


def report(client: InProcessClient, url: str, body: dict[str, object]) -> Response:
    return client.post(f"{url}/reports", json=body, headers={"Prefer": "wait=10"})


def seen(first: int, end: int) -> list[dict[str, object]]:
    """A patch with the hall's columns from `first` to `end`."""
    cells = np.ascontiguousarray(HALL[:, first:end])
    return [
        {"row": 0, "column": first, "width": end - first, "height": 12, "cells": write_cells(cells)}
    ]


def mission(strategy: str) -> dict[str, object]:
    return {
        "name": "unknown hall",
        "domain": "disaster",
        "strategy": strategy,
        "exploration": {},
        "map": {
            "resolution_m": 0.2,
            "origin_m": [0.0, 0.0],
            "width": 40,
            "height": 12,
            "cells": write_cells(np.full_like(HALL, -1)),
        },
        "robot_types": {"explorer": {"radius_m": 0.25, "speed_m_s": 1.0}},
        "robots": [{"id": "explorer_1", "type": "explorer", "pose": [1.0, 1.2, 0.0]}],
        "targets": [],
    }


def robot(x: float, command: str | None = None) -> list[dict[str, object]]:
    state = "idle" if command is None else "driving"
    return [{"id": "explorer_1", "pose": [x, 1.2, 0.0], "state": state, "command": command}]


def test_the_service_sends_robots_to_frontiers_until_none_is_left() -> None:
    with serving(create_app(Settings(database_url="sqlite://", executor="threads"))) as client:
        for strategy in ("segments", "greedy", "nearest", "planner"):
            url = client.post("/v1/missions", json=mission(strategy)).headers["location"]
            begun = report(client, url, {"sequence": 0, "time_s": 0.0, "robots": robot(1.0)})
            assert begun.json()["mission"]["status"] != "completed", strategy
            told = {"sequence": 1, "time_s": 1.0, "robots": robot(1.0), "map_patches": seen(0, 15)}
            (command,) = report(client, url, told).json()["commands"]
            assert command["kind"] == "explore", strategy
            assert command["location"] == "frontier:1"
            assert 2.0 < command["path_m"][-1][0] < 3.0
            further = {
                "sequence": 2,
                "time_s": 3.0,
                "robots": robot(2.6, command["id"]),
                "map_patches": seen(15, 28),
                "finished": [{"robot": "explorer_1", "command": command["id"]}],
            }
            (command,) = report(client, url, further).json()["commands"]
            assert 4.5 < command["path_m"][-1][0] < 5.6, strategy
            rest = {
                "sequence": 3,
                "time_s": 6.0,
                "robots": robot(5.0, command["id"]),
                "map_patches": seen(28, 40),
            }
            answer = report(client, url, rest).json()
            assert answer["mission"]["status"] == "completed", strategy
            assert "explored" in client.get(url).json()["status_reason"]


def test_what_cannot_be_seen_is_given_up() -> None:
    """The robot has been at the frontier and the map did not grow: that is the end of it."""
    with serving(create_app(Settings(database_url="sqlite://", executor="threads"))) as client:
        url = client.post("/v1/missions", json=mission("segments")).headers["location"]
        told = {"sequence": 0, "time_s": 0.0, "robots": robot(1.0), "map_patches": seen(0, 15)}
        (command,) = report(client, url, told).json()["commands"]
        there = {
            "sequence": 1,
            "time_s": 3.0,
            "robots": robot(command["path_m"][-1][0]),
            "finished": [{"robot": "explorer_1", "command": command["id"]}],
        }
        assert report(client, url, there).json()["mission"]["status"] == "completed"


def test_an_exploration_survives_a_restart(tmp_path: Path) -> None:
    settings = Settings(database_url=f"sqlite:///{tmp_path}/missions.sqlite", executor="threads")
    with serving(create_app(settings)) as client:
        url = client.post("/v1/missions", json=mission("segments")).headers["location"]
        told = {"sequence": 0, "time_s": 0.0, "robots": robot(1.0), "map_patches": seen(0, 15)}
        before = report(client, url, told).json()["commands"]
        targets = client.get(url).json()["targets"]
    with serving(create_app(settings)) as client:
        after = report(client, url, {"sequence": 1, "time_s": 1.0, "robots": robot(1.1)}).json()
        assert [c["location"] for c in after["commands"]] == [c["location"] for c in before]
        assert [t["id"] for t in client.get(url).json()["targets"]] == [t["id"] for t in targets]
