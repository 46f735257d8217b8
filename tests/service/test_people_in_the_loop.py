"""Joining, leaving, adding, removing, pinning, forbidding, taking over, canceling."""

from collections.abc import Iterator
from typing import Any

import pytest
from in_process import InProcessClient, serving
from scripted_fleet import Robot, ScriptedFleet, walls
from test_mission_loop import WAIT, drive

from service.app import create_app
from service.settings import Settings

HALL = walls(["#" * 22, *["#" + "." * 20 + "#"] * 6, "#" * 22])
EAST, WEST = (19.5, 3.5), (2.5, 5.5)


@pytest.fixture
def client() -> Iterator[InProcessClient]:
    with serving(create_app(Settings(database_url="sqlite://", planning_workers=1))) as started:
        yield started


def two_explorers() -> ScriptedFleet:
    return ScriptedFleet(
        [Robot("left", "explorer", (3.5, 3.5)), Robot("right", "explorer", (17.5, 3.5))]
    )


def begun(client: InProcessClient, team: ScriptedFleet, **more: Any) -> tuple[str, dict[str, Any]]:
    """A mission with a target in the east and one in the west, after the first report."""
    body = team.mission(HALL, [EAST, WEST], **more)
    url = client.post("/v1/missions", json=body).headers["location"]
    return url, tell(client, url, team)


def tell(client: InProcessClient, url: str, team: ScriptedFleet) -> dict[str, Any]:
    answer = client.post(f"{url}/reports", json=team.report(), headers=WAIT)
    assert answer.status_code == 200, answer.text
    body: dict[str, Any] = answer.json()
    team.obey(body)
    return body


def goals(answer: dict[str, Any]) -> dict[str, str | None]:
    return {command["robot"]: command["location"] for command in answer["commands"]}


def instruct(client: InProcessClient, url: str, **instruction: Any) -> str:
    answer = client.post(f"{url}/instructions", json=instruction, headers=WAIT)
    assert answer.status_code == 201, answer.text
    return str(answer.headers["location"])


def test_the_nearest_explorer_goes_without_instructions(client: InProcessClient) -> None:
    _, answer = begun(client, two_explorers())
    assert goals(answer) == {"left": "target_2", "right": "target_1"}


def test_a_pinned_robot_goes_and_nobody_else(client: InProcessClient) -> None:
    team = two_explorers()
    url, _ = begun(client, team)
    where = instruct(client, url, kind="pin", robot="left", location="target_1")
    assert goals(tell(client, url, team)) == {"left": "target_1", "right": "target_2"}
    assert client.delete(where, headers=WAIT).status_code == 200
    assert goals(tell(client, url, team)) == {"left": "target_2", "right": "target_1"}
    assert client.delete(where).status_code == 404


def test_a_forbidden_robot_does_not_go(client: InProcessClient) -> None:
    team = two_explorers()
    url, _ = begun(client, team)
    instruct(client, url, kind="forbid", robot="right", location="target_1")
    assert goals(tell(client, url, team)) == {"left": "target_1", "right": "target_2"}


def test_a_robot_taken_over_has_no_command_until_it_is_handed_back(
    client: InProcessClient,
) -> None:
    team = two_explorers()
    url, _ = begun(client, team)
    where = instruct(client, url, kind="take-over", robot="left")
    assert set(goals(tell(client, url, team))) == {"right"}
    mission = client.get(url).json()
    assert [robot["taken_over"] for robot in mission["robots"]] == [True, False]
    client.delete(where, headers=WAIT)
    assert goals(tell(client, url, team)) == {"left": "target_2", "right": "target_1"}


def test_a_robot_leaves_and_comes_back(client: InProcessClient) -> None:
    team = two_explorers()
    url, _ = begun(client, team)
    assert client.delete(f"{url}/robots/right", headers=WAIT).status_code == 200
    assert set(goals(tell(client, url, team))) == {"left"}
    robot = {"id": "right", "type": "explorer", "pose": [17.5, 3.5, 0.0]}
    assert client.post(f"{url}/robots", json=robot, headers=WAIT).status_code == 201
    assert goals(tell(client, url, team)) == {"left": "target_2", "right": "target_1"}
    again = client.post(f"{url}/robots", json=robot)
    assert again.status_code == 422
    assert again.json()["errors"][0]["location"] == "/id"
    assert client.delete(f"{url}/robots/nobody").status_code == 404


def test_a_new_robot_joins(client: InProcessClient) -> None:
    team = two_explorers()
    url, _ = begun(client, team)
    team.robots.append(Robot("third", "explorer", (19.5, 2.5)))
    robot = {"id": "third", "type": "explorer", "pose": [19.5, 2.5, 0.0]}
    assert client.post(f"{url}/robots", json=robot, headers=WAIT).status_code == 201
    assert goals(tell(client, url, team))["third"] == "target_1"


def test_targets_come_and_go(client: InProcessClient) -> None:
    team = two_explorers()
    url, _ = begun(client, team)
    target = {"id": "late", "position_m": [16.5, 2.5]}
    assert client.post(f"{url}/targets", json=target, headers=WAIT).status_code == 201
    assert client.delete(f"{url}/targets/target_1", headers=WAIT).status_code == 200
    assert goals(tell(client, url, team))["right"] == "late"
    wall = client.post(f"{url}/targets", json={"id": "x", "position_m": [0.5, 0.5]})
    assert wall.json()["errors"][0]["location"] == "/position_m"
    assert drive(client, url, team) == "completed"
    visited = {t["id"]: t["visited_by"] for t in client.get(url).json()["targets"]}
    assert visited == {"target_1": None, "target_2": "left", "late": "right"}


def test_removing_the_last_target_completes_the_mission(client: InProcessClient) -> None:
    team = two_explorers()
    url, _ = begun(client, team)
    for _ in range(2):
        team.step()
    tell(client, url, team)
    assert client.get(url).json()["targets_left"] == 1
    left = [t["id"] for t in client.get(url).json()["targets"] if t["visited_by"] is None]
    assert client.delete(f"{url}/targets/{left[0]}").json()["status"] == "completed"
    assert client.delete(url).status_code == 409
    target = {"id": "late", "position_m": [16.5, 2.5]}
    assert client.post(f"{url}/targets", json=target).status_code == 409


def test_a_canceled_mission_has_no_commands_and_stays_canceled(client: InProcessClient) -> None:
    team = two_explorers()
    url, _ = begun(client, team)
    assert client.delete(url).json()["status"] == "canceled"
    assert client.delete(url).status_code == 200
    team.step()
    answer = tell(client, url, team)
    assert answer["mission"]["status"] == "canceled"
    assert answer["commands"] == []
    kinds = [decision["kind"] for decision in client.get(url).json()["decisions"]]
    assert kinds.count("canceled") == 1


@pytest.mark.parametrize(
    ("body", "where"),
    [
        ({"kind": "pin", "robot": "nobody", "location": "target_1"}, "/robot"),
        ({"kind": "pin", "robot": "left", "location": "nowhere"}, "/location"),
        ({"kind": "deadline", "target": "nowhere", "time_s": 5.0}, "/target"),
        ({"kind": "priority", "target": "target_1", "priority": 0}, "/priority/priority"),
        ({"kind": "dance"}, ""),
        ({}, ""),
    ],
)
def test_an_instruction_nobody_can_follow_is_refused(
    client: InProcessClient, body: dict[str, Any], where: str
) -> None:
    url, _ = begun(client, two_explorers())
    answer = client.post(f"{url}/instructions", json=body)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["location"] == where


def test_a_silent_robot_is_planned_around_and_welcomed_back(client: InProcessClient) -> None:
    team = two_explorers()
    url, _ = begun(client, team, lease_s=5.0)
    silent = team.robots.pop(1)
    for _ in range(8):
        team.step()
        answer = tell(client, url, team)
    mission = client.get(url).json()
    assert [robot["lost"] for robot in mission["robots"]] == [False, True]
    assert goals(answer) == {"left": "target_1"}
    team.robots.append(silent)
    answer = tell(client, url, team)
    assert goals(answer)["right"] == "target_1"
    reasons = [d["reason"] for d in client.get(url).json()["decisions"]]
    assert any("right fell silent" in reason for reason in reasons)
    assert any("right is back" in reason for reason in reasons)


def test_a_failed_robot_is_planned_around(client: InProcessClient) -> None:
    team = two_explorers()
    url, _ = begun(client, team)
    team.robots[1].state, team.robots[1].path, team.robots[1].command = "failed", [], None
    answer = tell(client, url, team)
    assert set(goals(answer)) == {"left"}
    for _ in range(40):
        team.step()
        answer = tell(client, url, team)
        if answer["mission"]["status"] == "completed":
            break
    assert {t["visited_by"] for t in client.get(url).json()["targets"]} == {"left"}


def test_the_same_key_gives_the_same_mission(client: InProcessClient) -> None:
    body = two_explorers().mission(HALL, [EAST, WEST])
    key = {"Idempotency-Key": "2026-11-22/a"}
    first = client.post("/v1/missions", json=body, headers=key)
    again = client.post("/v1/missions", json=body, headers=key)
    assert again.status_code == 201
    assert again.headers["location"] == first.headers["location"]
    other = client.post("/v1/missions", json={**body, "name": "other"}, headers=key)
    assert other.status_code == 422
    assert other.json()["type"].endswith("idempotency-key-reused")
    assert len(client.get("/v1/missions").json()) == 1


def test_an_instruction_sent_again_under_its_key_counts_once(client: InProcessClient) -> None:
    url, _ = begun(client, two_explorers())
    key = {"Idempotency-Key": "stop left"}
    body = {"kind": "take-over", "robot": "left"}
    first = client.post(f"{url}/instructions", json=body, headers=key)
    again = client.post(f"{url}/instructions", json=body, headers=key)
    assert again.headers["location"] == first.headers["location"]
    assert len(client.get(url).json()["instructions"]) == 1
    other = client.post(f"{url}/instructions", json={**body, "robot": "right"}, headers=key)
    assert other.status_code == 422
