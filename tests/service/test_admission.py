"""Bad input gets a problem that says where it is, and never a 500."""

import copy
import json
import math
from typing import Any

import pytest
from in_process import InProcessClient, serving
from scripted_fleet import Robot, ScriptedFleet, walls

from service.app import create_app
from service.settings import Settings

MAP = walls(["######", "#....#", "#....#", "######"])


@pytest.fixture(scope="module")
def client() -> Any:
    settings = Settings(database_url="sqlite://", max_body_bytes=65536, max_map_cells=1000)
    with serving(create_app(settings)) as started:
        yield started


def mission() -> dict[str, Any]:
    team = ScriptedFleet([Robot("e", "explorer", (1.5, 1.5)), Robot("c", "clearer", (2.5, 1.5))])
    return team.mission(MAP, [(4.5, 2.5)])


def changed(path: str, value: Any) -> dict[str, Any]:
    """The mission with one value replaced, or removed if it is `...`."""
    body = copy.deepcopy(mission())
    *parents, last = [int(part) if part.isdigit() else part for part in path.split("/")[1:]]
    place: Any = body
    for part in parents:
        place = place[part]
    if value is ...:
        del place[last]
    else:
        place[last] = value
    return body


FAULTS: list[tuple[str, Any, str]] = [
    ("/surprise", 1, "/surprise"),
    ("/name", ..., "/name"),
    ("/name", 3, "/name"),
    ("/domain", "disastr", "/domain"),
    ("/strategy", "magic", "/strategy"),
    ("/map/resolution_m", "1.0", "/map/resolution_m"),
    ("/map/resolution_m", 0, "/map/resolution_m"),
    ("/map/width", 7, "/map/cells"),
    ("/map/width", 99999, "/map/width"),
    ("/map/cells", "@@@", "/map/cells"),
    ("/map/cells", "AAAA", "/map/cells"),
    ("/robots", [], "/robots"),
    ("/robots/0/pose", [1.5, 1.5], "/robots/0/pose/2"),
    ("/robots/0/pose", [0.5, 0.5, 0.0], "/robots/0/pose"),
    ("/robots/0/pose", [60.5, 0.5, 0.0], "/robots/0/pose"),
    ("/robots/0/pose", [1.5, math.nan, 0.0], "/robots/0/pose/1"),
    ("/robots/1/id", "e", "/robots/1/id"),
    ("/robots/1/type", "drone", "/robots/1/type"),
    ("/robots/1/carrier", "nobody", "/robots/1/carrier"),
    ("/robots/1/carrier", "e", "/robots/1/carrier"),
    ("/targets/0/position_m", [0.5, 1.5], "/targets/0/position_m"),
    ("/targets/0/id", "e", "/targets/0/id"),
    ("/robot_types/explorer/speed_m_s", -1.0, "/robot_types/explorer/speed_m_s"),
    ("/robot_types/explorer/enters", ["swamp"], "/robot_types/explorer/enters/0"),
]


@pytest.mark.parametrize(("path", "value", "where"), FAULTS)
def test_a_wrong_field_of_a_mission_is_named(
    client: InProcessClient, path: str, value: Any, where: str
) -> None:
    body = json.dumps(changed(path, value))
    answer = client.post("/v1/missions", content=body)
    assert answer.status_code == 422, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert where in [error["location"] for error in answer.json()["errors"]]
    assert answer.json()["detail"]


def test_a_wrong_type_of_robot_is_told_the_right_ones(client: InProcessClient) -> None:
    body = mission()
    body["robot_types"]["drone"] = body["robot_types"]["explorer"]
    answer = client.post("/v1/missions", json=body).json()
    assert "clearer, explorer" in answer["detail"]


@pytest.mark.parametrize("body", [b"", b"{", b"[]", b"null", b"\xff\xfe", b'"text"', b"1e999"])
def test_what_is_no_json_object_is_refused(client: InProcessClient, body: bytes) -> None:
    answer = client.post("/v1/missions", content=body)
    assert answer.status_code in (400, 422)
    assert answer.headers["content-type"] == "application/problem+json"


def test_a_large_body_is_refused(client: InProcessClient) -> None:
    answer = client.post("/v1/missions", content=b" " * 70_000)
    assert answer.status_code == 413
    assert answer.json()["status"] == 413


def test_there_is_no_such_mission(client: InProcessClient) -> None:
    for path in ("/v1/missions/none", "/v1/missions/none/plan", "/v1/missions/none/map"):
        assert client.get(path).status_code == 404
    assert client.get("/nowhere").headers["content-type"] == "application/problem+json"
    assert client.request("PATCH", "/healthz").status_code == 405


def test_a_wrong_field_of_a_report_is_named(client: InProcessClient) -> None:
    url = client.post("/v1/missions", json=mission()).headers["location"]
    robot = {"id": "e", "pose": [1.5, 1.5, 0.0], "state": "idle"}
    blockade = {"id": "b", "segment_m": [[1.0, 1.0], [2.0, 1.0]], "clear_duration_s": 1.0}
    good = {"sequence": 0, "time_s": 0.0, "robots": [robot]}
    faults: list[tuple[dict[str, Any], str]] = [
        ({"time_s": -1.0}, "/time_s"),
        ({"sequence": "0"}, "/sequence"),
        ({"sequence": 10**9}, "/sequence"),
        ({"robots": [{**robot, "id": "x"}]}, "/robots/0/id"),
        ({"robots": [robot, robot]}, "/robots/1/id"),
        ({"robots": [{**robot, "state": "dancing"}]}, "/robots/0/state"),
        ({"robots": [{**robot, "pose": [99.0, 0.0, 0.0]}]}, "/robots/0/pose"),
        ({"blockades": [{**blockade, "id": "e"}]}, "/blockades/0/id"),
        (
            {"blockades": [{**blockade, "segment_m": [[1, 1], [1e6, 1]]}]},
            "/blockades/0/segment_m/1",
        ),
        ({"finished": [{"robot": "e", "command": "r9-e"}]}, "/finished/0/command"),
        ({"finished": [{"robot": "x", "command": "r9-e"}]}, "/finished/0/robot"),
        ({"failed": [{"robot": "e", "command": "r9-e"}]}, "/failed/0/command"),
    ]
    for change, where in faults:
        answer = client.post(f"{url}/reports", json={**good, **change})
        assert answer.status_code == 422, (change, answer.text)
        assert where in [error["location"] for error in answer.json()["errors"]]
    assert client.get(url).json()["status"] == "queued"
    assert client.post(f"{url}/reports", json=good).status_code == 200
