"""From laser remission to orders: wheeled robots are not sent where grass was classified."""

import json
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from scenarios.in_process_service import ADDRESS, service_in_process
from scenarios.maps.park import park
from scenarios.mission import RunOptions, run_and_report
from service.settings import Settings
from simulator.vegetation.publication import map_patches, mission_map
from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.terrain_grid import TerrainGrid

SCENARIO = Path(__file__).parents[2] / "scenarios" / "marsupial" / "park.toml"


@pytest.mark.slow
def test_the_park_mission_completes_with_clean_wheels(tmp_path: Path) -> None:
    record = tmp_path / "park.json"
    run_and_report(SCENARIO, RunOptions(seed=1, headless=True, json_file=record))
    mission = json.loads(record.read_text(encoding="utf-8"))
    assert mission["status"] == "completed"
    world = park(3).world
    for robot in mission["robots"]:
        trail = np.array(robot["trail"])[:, 1:]
        touched = world.touched(trail, 0.4 if robot["type"] == "carrier" else 0.25)
        if robot["type"] == "carrier":
            assert not np.isin(touched, [Material.LAWN, Material.GRAVEL]).any()
    rovers = [robot for robot in mission["robots"] if robot["type"] == "rover"]
    on_grass = [
        np.isin(world.material_at(np.array(r["trail"])[:, 1:]), [Material.LAWN]) for r in rovers
    ]
    assert any(grass.any() for grass in on_grass)


def field(grass: bool) -> TerrainGrid:
    """20 m x 10 m of free ground, once classified with a lawn in the middle of its south."""
    chance = np.full((50, 100), 0.1)
    if grass:
        chance[:35, 40:60] = 0.9
    return TerrainGrid(np.zeros((50, 100), np.int8), chance, 0.2, (0.0, 0.0))


def lowest_y(path: list[list[float]]) -> float:
    """Lowest point of a way between x = 8 and x = 12, the lawn's extent."""
    points = np.array(path)
    x = np.linspace(8.0, 12.0, 41)
    return float(np.interp(x, points[:, 0], points[:, 1]).min())


def test_grass_classified_during_a_mission_bends_the_way() -> None:
    """Patches of a report close the lawn for the wheelchair; its way then leads around it."""
    robot = {"id": "chair_1", "type": "explorer", "pose": [2.0, 2.0, 0.0]}
    mission: dict[str, Any] = {
        "name": "lawn",
        "domain": "disaster",
        "strategy": "planner",
        "map": mission_map(field(grass=False), verge_m=0.4),
        "robot_types": {
            "explorer": {
                "radius_m": 0.4,
                "speed_m_s": 1.0,
                "sensor_range_m": 5.0,
                "enters": ["paved"],
            }
        },
        "robots": [robot],
        "targets": [{"id": "target_1", "position_m": [18.0, 2.0]}],
    }
    report: dict[str, Any] = {
        "time_s": 1.0,
        "robots": [{"id": "chair_1", "pose": robot["pose"], "state": "idle"}],
    }
    wait = {"Prefer": "wait=20"}
    with service_in_process(Settings(database_url="sqlite://", planning_workers=1)) as transport:
        client = httpx.Client(transport=transport, base_url=ADDRESS)
        url = client.post("/v1/missions", json=mission).raise_for_status().headers["location"]
        sent = {**report, "sequence": 0}
        first = client.post(f"{url}/reports", json=sent, headers=wait).json()["commands"][0]
        patches = map_patches(field(grass=True), field(grass=False), verge_m=0.4)
        sent = {**report, "sequence": 1, "time_s": 2.0, "map_patches": patches}
        second = client.post(f"{url}/reports", json=sent, headers=wait).json()["commands"][0]
    assert lowest_y([robot["pose"][:2], *first["path_m"]]) < 3.0
    assert lowest_y([robot["pose"][:2], *second["path_m"]]) > 7.0
    assert second["location"] == "target_1"
