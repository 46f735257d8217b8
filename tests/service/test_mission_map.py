"""Sensed map patches: what they change, what is planned anew, and what is not computed again."""

import base64
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from in_process import InProcessClient, serving
from scripted_fleet import Robot, ScriptedFleet, map_json, walls
from test_mission_loop import WAIT, drive

from semantic_attachments.path_costs import PathCosts
from semantic_attachments.world import GridMap
from service.app import create_app
from service.coordination.mission_map import MissionMap
from service.messages.report import MapPatch
from service.settings import Settings

# Two ways from west to east: through the door in the middle, or round by the north.
HALLS = walls(
    [
        "####################",
        "#..................#",
        "#..................#",
        "#........##........#",
        "#........##........#",
        "#..................#",
        "#..................#",
        "#........##........#",
        "####################",
    ]
)
DOOR = {"row": 2, "column": 9, "width": 2, "height": 2}


def packed(cells: list[list[int]]) -> str:
    return base64.b64encode(zlib.compress(np.array(cells, dtype=np.int8).tobytes())).decode()


def patch(row: int, column: int, cells: list[list[int]], **more: Any) -> dict[str, Any]:
    shape = {"width": len(cells[0]), "height": len(cells)}
    return {"row": row, "column": column, **shape, "cells": packed(cells), **more}


SHUT = patch(2, 9, [[100, 100], [100, 100]])
OPEN = patch(2, 9, [[0, 0], [0, 0]])


@pytest.fixture
def client() -> Iterator[InProcessClient]:
    with serving(create_app(Settings(database_url="sqlite://", planning_workers=1))) as started:
        yield started


def begun(client: InProcessClient, **more: Any) -> tuple[str, ScriptedFleet]:
    team = ScriptedFleet([Robot("explorer_1", "explorer", (4.5, 3.0))])
    body = team.mission(HALLS, [(16.5, 3.0)], **more)
    return client.post("/v1/missions", json=body).headers["location"], team


def tell(
    client: InProcessClient, url: str, team: ScriptedFleet, *patches: dict[str, Any]
) -> dict[str, Any]:
    report = {**team.report(), "map_patches": list(patches)}
    answer = client.post(f"{url}/reports", json=report, headers=WAIT)
    assert answer.status_code == 200, answer.text
    body: dict[str, Any] = answer.json()
    team.obey(body)
    return body


def highest_m(command: dict[str, Any]) -> float:
    return max(y for _, y in command["path_m"])


@pytest.mark.parametrize("strategy", ["planner", "hungarian"])
def test_a_door_found_shut_sends_the_robot_round(client: InProcessClient, strategy: str) -> None:
    url, team = begun(client, strategy=strategy)
    (straight,) = tell(client, url, team)["commands"]
    assert highest_m(straight) < 4.5
    team.step()
    (round_,) = tell(client, url, team, SHUT)["commands"]
    assert round_["id"] != straight["id"]
    assert highest_m(round_) > 5.5
    assert round_["expected_duration_s"] > straight["expected_duration_s"]
    reasons = [d["reason"] for d in client.get(url).json()["decisions"]]
    assert any("the map changed in 4 cells" in reason for reason in reasons)
    assert drive(client, url, team) == "completed"


def test_the_known_map_shows_what_was_sensed(client: InProcessClient) -> None:
    url, team = begun(client)
    tell(client, url, team, SHUT)
    known = client.get(f"{url}/map").json()
    cells = np.frombuffer(zlib.decompress(base64.b64decode(known["cells"])), np.int8)
    cells = cells.reshape(known["height"], known["width"])
    assert (cells[2:4, 9:11] == 100).all()
    assert (cells[4:6, 9:11] == np.array(HALLS)[4:6, 9:11]).all()
    log = client.app.state.store
    from service.coordination.history import rebuilt

    again = rebuilt(log.events(url.rsplit("/", 1)[1]))
    assert again.map.version == 1
    assert (again.map.grid.cells == cells).all()


def test_a_patch_that_says_nothing_new_is_no_reason_to_plan(client: InProcessClient) -> None:
    url, team = begun(client)
    tell(client, url, team)
    before = client.get(url).json()
    tell(client, url, team, OPEN, patch(0, 0, [[100, -1], [-1, 0]]), patch(1, 1, [[30]]))
    after = client.get(url).json()
    assert after["revision"] == before["revision"]
    assert after["replans"] == before["replans"]


def test_a_patch_away_from_the_path_keeps_the_command(client: InProcessClient) -> None:
    url, team = begun(client)
    (first,) = tell(client, url, team)["commands"]
    (second,) = tell(client, url, team, patch(7, 2, [[100, 100, 100]]))["commands"]
    assert second["id"] == first["id"]


def test_a_target_behind_a_wall_just_sensed_is_waited_for(client: InProcessClient) -> None:
    url, team = begun(client)
    tell(client, url, team)
    sealed = patch(1, 9, [[100, 100]] * 7)
    answer = tell(client, url, team, sealed)
    assert answer["mission"]["status"] == "delayed"
    assert answer["commands"] == []  # rather than into the wall
    answer = tell(client, url, team, OPEN)
    assert answer["mission"]["status"] == "underway"
    assert drive(client, url, team) == "completed"


@pytest.mark.parametrize(
    ("wrong", "where"),
    [
        ({**SHUT, "row": 8}, "/map_patches/0/row"),
        ({**SHUT, "column": 19}, "/map_patches/0/column"),
        ({**SHUT, "width": 3}, "/map_patches/0/cells"),
        ({**SHUT, "cells": "???"}, "/map_patches/0/cells"),
        ({**SHUT, "row": -1}, "/map_patches/0/row"),
        (patch(2, 9, [[101]]), "/map_patches/0/cells"),
        (patch(2, 9, [[0]], terrain=packed([[1]])), "/map_patches/0/terrain"),
    ],
)
def test_a_patch_that_does_not_fit_is_refused(
    client: InProcessClient, wrong: dict[str, Any], where: str
) -> None:
    url, team = begun(client)
    answer = client.post(f"{url}/reports", json={**team.report(), "map_patches": [wrong]})
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["location"] == where
    assert client.get(url).json()["sequence"] == -1


def test_a_report_that_was_overtaken_does_not_undo_what_came_later(client: InProcessClient) -> None:
    url, team = begun(client)
    tell(client, url, team)
    overtaken = {**team.report(), "map_patches": [patch(2, 8, [[0, 0, 0]]), patch(6, 4, [[100]])]}
    tell(client, url, team, SHUT)
    client.post(f"{url}/reports", json=overtaken, headers=WAIT)
    known = client.get(f"{url}/map").json()
    cells = np.frombuffer(zlib.decompress(base64.b64decode(known["cells"])), np.int8)
    cells = cells.reshape(known["height"], known["width"])
    assert cells[2, 9] == 100
    assert cells[6, 4] == 100


def test_terrain_is_sensed_too() -> None:
    grid = GridMap(np.zeros((4, 4), np.int8), 1.0, terrain_classes=("floor", "rubble"))
    known = MissionMap(grid)
    message = MapPatch.model_validate_json(
        MapPatch(row=1, column=1, width=2, height=1, cells=packed([[0, -1]]),
                 terrain=packed([[1, 1]])).model_dump_json()
    )  # fmt: skip
    assert known.change(0, [message]).cells == 1
    known.apply(0, [message])
    assert known.grid.terrain is not None
    assert known.grid.terrain.tolist() == [[0] * 4, [0, 1, 0, 0], [0] * 4, [0] * 4]
    assert known.change(1, [message]).cells == 0


def test_costs_are_computed_again_only_where_the_map_changed() -> None:
    """A wall in the far corner leaves the costs between places elsewhere as they are."""
    team = ScriptedFleet([Robot("explorer_1", "explorer", (2.5, 2.5))])
    wide = walls(["#" * 62, *["#" + "." * 60 + "#"] * 20, "#" * 62])
    targets = [(5.5, 3.5), (8.5, 6.5), (11.5, 3.5), (4.5, 9.5), (57.5, 17.5)]
    body = team.mission(wide, targets, strategy="planner")
    wall = patch(14, 55, [[100]] * 6)
    # What workers that are processes keep cannot be looked at.
    with serving(create_app(Settings(database_url="sqlite://", executor="threads"))) as client:
        url = client.post("/v1/missions", json=body).headers["location"]
        tell(client, url, team)
        tell(client, url, team, wall)
        memory = client.app.state.missions._planners._memories[url.rsplit("/", 1)[1]]
    costs = memory.get("grid", PathCosts)
    assert costs is not None
    assert costs.world.grid.cells[15, 55] == 100
    assert sum(len(layer.legs) for layer in costs._layers.values()) >= 10
    # The pairs among the four targets in the west were kept, those across the wall were not.
    assert costs.statistics.kept >= 6
    assert costs.statistics.kept > costs.statistics.forgotten


def test_map_json_of_the_tests_is_the_protocols() -> None:
    assert map_json(HALLS)["cells"] == packed(HALLS)
