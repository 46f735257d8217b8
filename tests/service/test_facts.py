"""Robots that get stuck, and missions that cannot go on."""

from itertools import pairwise
from typing import Any

from in_process import InProcessClient, serving
from scripted_fleet import Robot, ScriptedFleet, walls
from test_mission_loop import WAIT, drive

from service.app import create_app
from service.settings import Settings

HALL = walls(["#" * 22, *["#" + "." * 20 + "#"] * 4, "#" * 22])
SEALED = walls(["##########", "#....#...#", "#....#...#", "##########"])
FAR, NEAR = (19.5, 2.5), (6.5, 2.5)


def two_explorers() -> ScriptedFleet:
    return ScriptedFleet(
        [Robot("stuck", "explorer", (16.5, 2.5)), Robot("sound", "explorer", (2.5, 2.5))]
    )


def tell(client: InProcessClient, url: str, team: ScriptedFleet) -> dict[str, Any]:
    answer = client.post(f"{url}/reports", json=team.report(), headers=WAIT)
    assert answer.status_code == 200, answer.text
    body: dict[str, Any] = answer.json()
    return body


def test_a_robot_that_is_late_and_stands_still_fails_its_command_and_others_go() -> None:
    """It says it is driving, for ever; the plan that counts on it must not go on for ever."""
    team = two_explorers()
    stuck = team.robots[0]
    ids: list[str] = []
    with serving(create_app(Settings(database_url="sqlite://", give_up_s=20.0))) as client:
        body = team.mission(HALL, [FAR, NEAR], strategy="planner")
        url = client.post("/v1/missions", json=body).headers["location"]
        for _ in range(200):
            answer = tell(client, url, team)
            if answer["mission"]["status"] == "completed":
                break
            given = {command["robot"]: command for command in answer["commands"]}
            if given["stuck"]["kind"] == "explore" and given["stuck"]["id"] not in ids:
                ids.append(given["stuck"]["id"])
            team.obey(answer)
            stuck.path = []
            team.step()
        mission = client.get(url).json()
    assert mission["status"] == "completed"
    assert {target["visited_by"] for target in mission["targets"]} == {"sound"}
    failed = [d for d in mission["decisions"] if d["kind"] == "command failed"]
    assert failed
    assert "stuck is not carrying out explore target_1" in failed[0]["reason"]
    # The times at which it was given up are apart: it is not given up at every report.
    times = [decision["time_s"] for decision in failed]
    assert all(later - earlier > 20.0 for earlier, later in pairwise(times))


def test_a_robot_that_drives_slowly_is_late_but_keeps_its_command() -> None:
    team = ScriptedFleet([Robot("slow", "explorer", (2.5, 2.5))], step_s=0.1)
    with serving(create_app(Settings(database_url="sqlite://", give_up_s=5.0))) as client:
        body = team.mission(HALL, [(8.5, 2.5)])
        url = client.post("/v1/missions", json=body).headers["location"]
        for _ in range(200):
            answer = tell(client, url, team)
            if answer["mission"]["status"] == "completed":
                break
            team.obey(answer)
            team.step()
            team.time_s += 0.9
        mission = client.get(url).json()
    assert mission["status"] == "completed"
    assert mission["time_s"] > 50.0
    kinds = [decision["kind"] for decision in mission["decisions"]]
    assert "command failed" not in kinds
    assert any("slow is late" in decision["reason"] for decision in mission["decisions"])


def hopeless(strategy: str) -> tuple[ScriptedFleet, dict[str, Any]]:
    team = ScriptedFleet([Robot("explorer_1", "explorer", (1.5, 1.5))])
    return team, team.mission(SEALED, [(3.5, 1.5), (7.5, 1.5)], strategy=strategy)


def test_a_mission_that_nobody_can_go_on_with_fails_once_and_says_why() -> None:
    for strategy in ("planner", "hungarian"):
        team, body = hopeless(strategy)
        with serving(create_app(Settings(database_url="sqlite://", hopeless_s=45.0))) as client:
            url = client.post("/v1/missions", json=body).headers["location"]
            assert drive(client, url, team) == "failed"
            ended_s = team.time_s
            for _ in range(3):
                team.step()
                assert tell(client, url, team)["mission"]["status"] == "failed"
            mission = client.get(url).json()
        first, second = mission["targets"]
        assert first["visited_by"] == "explorer_1"
        assert second["visited_by"] is None
        assert ended_s >= first["visited_at_s"] + 45.0
        assert "no robot can reach" in mission["status_reason"]
        assert "45 s" in mission["status_reason"]
        ends = [d["kind"] for d in mission["decisions"]]
        assert sum(kind in ("completed", "failed", "canceled") for kind in ends) == 1


def test_hope_comes_back_with_whoever_can_reach_what_is_left() -> None:
    team, body = hopeless("planner")
    with serving(create_app(Settings(database_url="sqlite://", hopeless_s=60.0))) as client:
        url = client.post("/v1/missions", json=body).headers["location"]
        for _ in range(40):
            answer = tell(client, url, team)
            team.obey(answer)
            team.step()
        assert answer["mission"]["status"] == "delayed"
        robot = {"id": "explorer_2", "type": "explorer", "pose": [6.5, 1.5, 0.0]}
        assert client.post(f"{url}/robots", json=robot, headers=WAIT).status_code == 201
        team.robots.append(Robot("explorer_2", "explorer", (6.5, 1.5)))
        assert drive(client, url, team) == "completed"
