"""Carriers and rovers: meeting points, deployment and retrieval (thesis 3.4, 3.6.3)."""

from typing import Any

import numpy as np
import pytest
from in_process import serving
from scripted_fleet import Robot, ScriptedFleet, map_json, walls
from test_mission_loop import drive

from domains.mission_state import MeetingPoint
from semantic_attachments.world import GridMap, RobotModel
from service.app import create_app
from service.coordination.meeting_points import meeting_points
from service.settings import Settings

# Below a hall for carriers; above two rooms that only rovers can enter, marked by r.
DRAWING = [
    "######################",
    "#rrrrrrrr#rrrrrrrrrrr#",
    "#rrrrrrrr#rrrrrrrrrrr#",
    "#rrrrrrrr#rrrrrrrrrrr#",
    "####rr#########rr#####",
    "#....................#",
    "#....................#",
    "#....................#",
    "######################",
]
CELLS = walls([row.replace("r", ".") for row in DRAWING])
TERRAIN = [[int(cell == "r") for cell in row] for row in reversed(DRAWING)]


def mission(team: ScriptedFleet, strategy: str, carrier_radius_m: float = 0.3) -> dict[str, Any]:
    body = team.mission(CELLS, [(2.5, 7.5), (18.5, 7.5), (12.5, 6.5), (2.5, 1.5)])
    body |= {"domain": "marsupial", "strategy": strategy}
    body["map"] |= {
        "terrain": map_json(TERRAIN)["cells"],
        "terrain_classes": ["default", "rough"],
    }
    kind = {"radius_m": 0.3, "speed_m_s": 1.0, "sensor_range_m": 4.0}
    body["robot_types"] = {
        "carrier": {
            **kind,
            "radius_m": carrier_radius_m,
            "enters": ["default"],
            "capacity": 1,
        },
        "rover": {**kind, "enters": ["default", "rough"]},
    }
    for entry, robot in zip(body["robots"], team.robots, strict=True):
        entry["carrier"] = robot.carrier
    return body


@pytest.mark.parametrize("carrier_radius_m", [0.3, 1.3], ids=["small", "wider than the doors"])
@pytest.mark.parametrize("strategy", ["hungarian", "planner"])
def test_a_rover_is_carried_put_down_and_fetched(strategy: str, carrier_radius_m: float) -> None:
    team = ScriptedFleet(
        [
            Robot("carrier_1", "carrier", (18.5, 2.5)),
            Robot("rover_1", "rover", (18.5, 2.5), state="docked", carrier="carrier_1"),
        ]
    )
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        created = client.post("/v1/missions", json=mission(team, strategy, carrier_radius_m))
        assert created.status_code == 201, created.text
        url = created.headers["location"]
        assert drive(client, url, team) == "completed"
        detail = client.get(url).json()
    visited = {target["id"]: target["visited_by"] for target in detail["targets"]}
    assert {visited[f"target_{n}"] for n in (1, 2, 3)} == {"rover_1"}
    assert ("rover_1", "undock") in {(robot, kind) for robot, kind, _ in team.executed}


def test_a_border_has_a_meeting_point_on_the_carriers_side() -> None:
    grid = GridMap(
        np.array(CELLS), 1.0, terrain=np.array(TERRAIN), terrain_classes=("default", "rough")
    )
    models = {
        "carrier": RobotModel("carrier", 0.3, 1.0, enters=("default",), capacity=2),
        "rover": RobotModel("rover", 0.3, 1.0, enters=("default", "rough")),
    }
    points = meeting_points(grid, models)
    assert len(points) == 2
    for point in points:
        cell = grid.cell_at(point.position_m)
        assert cell is not None
        assert grid.terrain is not None
        assert grid.terrain.ravel()[cell] == 0
        assert point.position_m[1] == 3.5
    assert meeting_points(grid, {"rover": models["rover"]}) == ()


def test_a_long_border_has_several() -> None:
    terrain = np.zeros((10, 60), dtype=np.uint8)
    terrain[5:] = 1
    grid = GridMap(
        np.zeros((10, 60), dtype=np.int8), 0.5, terrain=terrain, terrain_classes=("a", "b")
    )
    models = {
        "carrier": RobotModel("carrier", 0.3, 1.0, enters=("a",), capacity=2),
        "rover": RobotModel("rover", 0.3, 1.0, enters=("b",)),
    }
    assert [point.position_m[1] for point in meeting_points(grid, models)] == [2.25] * 3


def test_meeting_points_stay_where_they_are_while_the_border_grows() -> None:
    """Seen bit by bit, a border keeps its meeting points and gets more where it has none."""
    terrain = np.zeros((10, 60), dtype=np.uint8)
    terrain[5:] = 1
    models = {
        "carrier": RobotModel("carrier", 0.3, 1.0, enters=("a",), capacity=2),
        "rover": RobotModel("rover", 0.3, 1.0, enters=("b",)),
    }

    def seen(columns: int, occupancy: int = 0) -> GridMap:
        cells = np.full((10, 60), -1, dtype=np.int8)
        cells[:, :columns] = occupancy
        return GridMap(cells, 0.5, terrain=terrain, terrain_classes=("a", "b"))

    points: tuple[MeetingPoint, ...] = ()
    counts = []
    for columns in (6, 20, 30, 60):
        grown = meeting_points(seen(columns), models, points)
        assert grown[: len(points)] == points
        points = grown
        counts.append(len(points))
    assert counts == [1, 1, 2, 3]
    assert meeting_points(seen(60, occupancy=100), models, points) == ()
