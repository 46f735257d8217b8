"""Several robots' scans become one octree over the service, and its passages the planner's map."""

import importlib
import sys
import tomllib
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import octomap
import pytest

from service.app import create_app
from service.scan_maps import read_scan
from service.settings import Settings
from simulator.mapping.fleet_map import FleetMap, scan_message
from simulator.mapping.octree import OctreeMap
from simulator.mapping.scene import DepthSensor, tabletop_scene

sys.path.insert(0, str(Path(__file__).parents[1] / "service"))
from in_process import InProcessClient, serving
from scripted_fleet import map_json

SENSOR = DepthSensor(horizontal_field_rad=1.2, vertical_field_rad=1.1)
PLACES = {"explorer_1": (-2.0, 0.0, 0.0), "explorer_2": (2.0, 0.0, np.pi)}


@pytest.fixture
def client() -> Iterator[InProcessClient]:
    settings = Settings(database_url="sqlite://", planning_workers=1)
    with serving(create_app(settings, scan_maps=FleetMap)) as started:
        yield started


def mission(enters: list[str]) -> dict[str, Any]:
    """An unknown room of 6 x 6 m with a table in the middle, a robot on either side of it."""
    plan = map_json([[0] * 60 for _ in range(60)], 0.1)
    kind = {"radius_m": 0.15, "speed_m_s": 1.0, "sensor_range_m": 5.0, "enters": enters}
    return {
        "name": "table",
        "domain": "disaster",
        "map": {**plan, "origin_m": [-3.0, -3.0], "terrain_classes": ["default", "low"]},
        "robot_types": {"explorer": kind},
        "robots": [
            {"id": name, "type": "explorer", "pose": list(pose)} for name, pose in PLACES.items()
        ],
        "targets": [
            {"id": "east", "position_m": [1.5, 0.05]},
            {"id": "w", "position_m": [-1.5, 0.0]},
        ],
        "planning": {"time_limit_s": 0.5},
    }


def scans() -> list[tuple[str, tuple[float, float, float], np.ndarray]]:
    found = []
    for robot, (x, y, yaw) in PLACES.items():
        for z, pitch in ((0.4, 0.15), (1.3, 0.5)):
            points = SENSOR.measure(tabletop_scene(), (x, y, z), yaw, pitch)
            found.append((robot, (x, y, z), points))
    return found


def fuse(client: InProcessClient, url: str) -> dict[str, Any]:
    for robot, origin, points in scans():
        answer = client.post(
            f"{url}/scans?robot={robot}&resolution_m=0.05", content=scan_message(origin, points)
        )
        assert answer.status_code == 200, answer.text
    body: dict[str, Any] = answer.json()
    return body


def test_scans_of_two_robots_become_one_octree(client: InProcessClient, tmp_path: Path) -> None:
    url = client.post("/v1/missions", json=mission(["default"])).headers["location"]
    assert fuse(client, url)["scans"] == {"explorer_1": 2, "explorer_2": 2}
    here = OctreeMap(0.05)
    for _, origin, points in scans():
        # What the message rounds to its steps of 5 mm is rounded here as well.
        here.insert_scan(*read_scan(scan_message(origin, points)))
    assert client.get(f"{url}/scan-map?format=ot").content == here.to_bytes(".ot")
    (tmp_path / "room.bt").write_bytes(client.get(f"{url}/scan-map").content)
    tree = octomap.OcTree(bytes(tmp_path / "room.bt"))
    assert tree.isNodeOccupied(tree.search(np.array([0.0, 0.0, 0.74])))


@pytest.mark.parametrize(("enters", "under"), [(["default"], False), (["default", "low"], True)])
def test_a_low_robot_is_sent_under_the_table_and_a_tall_one_round_it(
    client: InProcessClient, enters: list[str], under: bool
) -> None:
    body = mission(enters)
    body["robots"] = body["robots"][:1]
    body["targets"] = body["targets"][:1]
    url = client.post("/v1/missions", json=body).headers["location"]
    for _, origin, points in scans():
        message = scan_message(origin, points)
        client.post(f"{url}/scans?robot=explorer_1&resolution_m=0.05", content=message)
    heights = "height=default:1.5&height=low:0.5"
    patch = client.get(f"{url}/scan-map/passages?{heights}").json()
    robots = [{"id": "explorer_1", "pose": [-2.0, 0.0, 0.0], "state": "idle"}]
    report = {"sequence": 0, "time_s": 0.0, "robots": robots, "map_patches": [patch]}
    answer = client.post(f"{url}/reports", json=report, headers={"Prefer": "wait=20"}).json()
    (command,) = answer["commands"]
    path = np.array(command["path_m"])
    assert path[-1] == pytest.approx([1.5, 0.05], abs=0.2)
    along = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(path)])
    over = (np.abs(along[:, 0]) < 0.55) & (np.abs(along[:, 1]) < 0.35)
    assert over.any() == under


def test_the_installation_names_the_map_that_the_service_looks_for() -> None:
    text = (Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8")
    (target,) = tomllib.loads(text)["project"]["entry-points"]["marsupial.scan_maps"].values()
    module, _, name = target.partition(":")
    assert getattr(importlib.import_module(module), name) is FleetMap
