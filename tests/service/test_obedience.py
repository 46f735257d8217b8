"""Priorities, deadlines, pins: the next plan obeys or says why it cannot, whatever the strategy."""

from collections.abc import Iterator
from typing import Any

import pytest
from in_process import InProcessClient, serving
from scripted_fleet import HiddenBlockade, Robot, ScriptedFleet, walls
from test_mission_loop import WAIT, drive
from test_people_in_the_loop import goals, instruct, tell

from service.app import create_app
from service.settings import Settings

HALL = walls(["#" * 42, *["#" + "." * 40 + "#"] * 6, "#" * 42])
NEAR, MIDDLE, FAR = (8.5, 3.5), (20.5, 3.5), (38.5, 3.5)
STRATEGIES = ["planner", "hungarian", "greedy-clearing"]
BRIEF = {"time_limit_s": 0.05}


@pytest.fixture(scope="module")
def client() -> Iterator[InProcessClient]:
    with serving(create_app(Settings(database_url="sqlite://", planning_workers=1))) as started:
        yield started


def begun(client: InProcessClient, *robots: Robot, **more: Any) -> tuple[str, ScriptedFleet]:
    team = ScriptedFleet(list(robots) or [Robot("left", "explorer", (3.5, 3.5))])
    body = team.mission(HALL, [NEAR, MIDDLE, FAR], planning=BRIEF, **more)
    url = client.post("/v1/missions", json=body).headers["location"]
    tell(client, url, team)
    return url, team


def remark(client: InProcessClient, url: str, where: str) -> str:
    given = {one["id"]: one for one in client.get(url).json()["instructions"]}
    return str(given[where.rsplit("/", 1)[1]]["remark"])


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_priority_comes_first(client: InProcessClient, strategy: str) -> None:
    # The shortest round begins in the west.
    url, team = begun(client, Robot("left", "explorer", (14.5, 3.5)), strategy=strategy)
    where = instruct(client, url, kind="priority", target="target_3", priority=7)
    assert goals(tell(client, url, team)) == {"left": "target_3"}
    assert remark(client, url, where) == ""
    assert drive(client, url, team) == "completed"
    assert team.executed[0][2] == "target_3"


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_deadline_is_met_where_it_can_be(client: InProcessClient, strategy: str) -> None:
    url, team = begun(client, strategy=strategy)
    # Straight there it takes 35 s, by way of the others the same: a detour would be too long.
    where = instruct(client, url, kind="deadline", target="target_2", time_s=18.0)
    answer = tell(client, url, team)
    assert goals(answer)["left"] in ("target_1", "target_2")
    assert remark(client, url, where) == ""
    assert drive(client, url, team) == "completed"
    visited = {t["id"]: t["visited_at_s"] for t in client.get(url).json()["targets"]}
    assert visited["target_2"] <= 18.0


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_deadline_that_cannot_be_met_is_told(client: InProcessClient, strategy: str) -> None:
    url, team = begun(client, strategy=strategy)
    where = instruct(client, url, kind="deadline", target="target_3", time_s=5.0)
    assert goals(tell(client, url, team))["left"] is not None
    assert "the earliest visit found is at 35." in remark(client, url, where)


def test_two_deadlines_are_planned_in_the_order_that_meets_both(client: InProcessClient) -> None:
    # In the shortest round the east comes last; both deadlines hold only the other way round.
    team = ScriptedFleet([Robot("left", "explorer", (20.5, 3.5))])
    body = team.mission(HALL, [(12.5, 3.5), (38.5, 3.5)], strategy="planner", planning=BRIEF)
    url = client.post("/v1/missions", json=body).headers["location"]
    assert goals(tell(client, url, team)) == {"left": "target_1"}
    east = instruct(client, url, kind="deadline", target="target_2", time_s=20.0)
    west = instruct(client, url, kind="deadline", target="target_1", time_s=60.0)
    assert goals(tell(client, url, team)) == {"left": "target_2"}
    assert remark(client, url, east) == remark(client, url, west) == ""
    assert drive(client, url, team) == "completed"
    visited = {t["id"]: t["visited_at_s"] for t in client.get(url).json()["targets"]}
    assert visited["target_2"] <= 20.0
    assert visited["target_1"] <= 60.0


def test_of_deadlines_that_exclude_one_another_one_is_met(client: InProcessClient) -> None:
    team = ScriptedFleet([Robot("left", "explorer", (20.5, 3.5))])
    body = team.mission(HALL, [(12.5, 3.5), (38.5, 3.5)], strategy="planner", planning=BRIEF)
    url = client.post("/v1/missions", json=body).headers["location"]
    tell(client, url, team)
    east = instruct(client, url, kind="deadline", target="target_2", time_s=20.0)
    west = instruct(client, url, kind="deadline", target="target_1", time_s=15.0)
    told = [remark(client, url, where) for where in (east, west)]
    assert sorted(bool(one) for one in told) == [False, True]
    assert "the earliest visit found is at" in "".join(told)


def test_a_deadline_and_a_priority_go_together(client: InProcessClient) -> None:
    url, team = begun(
        client, Robot("left", "explorer", (3.5, 3.5)), Robot("right", "explorer", (39.5, 5.5)),
        strategy="planner",
    )  # fmt: skip
    by_time = instruct(client, url, kind="deadline", target="target_1", time_s=10.0)
    first = instruct(client, url, kind="priority", target="target_2", priority=5)
    assert goals(tell(client, url, team)) == {"left": "target_1", "right": "target_3"}
    assert remark(client, url, by_time) == remark(client, url, first) == ""
    assert drive(client, url, team) == "completed"
    visited = {t["id"]: t["visited_at_s"] for t in client.get(url).json()["targets"]}
    assert visited["target_1"] <= 10.0
    # As soon as if it were all that counts: it is on the way.
    assert visited["target_2"] <= 19.0


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_contradictions_are_told(client: InProcessClient, strategy: str) -> None:
    url, _ = begun(
        client, Robot("left", "explorer", (3.5, 3.5)), Robot("right", "explorer", (39.5, 5.5)),
        strategy=strategy,
    )  # fmt: skip
    pin = instruct(client, url, kind="pin", robot="left", location="target_3")
    assert remark(client, url, pin) == ""
    forbid = instruct(client, url, kind="forbid", robot="left", location="target_3")
    assert "left is forbidden to go there" in remark(client, url, pin)
    client.delete(forbid, headers=WAIT)
    assert remark(client, url, pin) == ""
    other = instruct(client, url, kind="pin", robot="right", location="target_3")
    assert "pinned to right as well" in remark(client, url, pin)
    assert "pinned to left as well" in remark(client, url, other)
    client.delete(other, headers=WAIT)
    instruct(client, url, kind="take-over", robot="left")
    assert "left takes no part" in remark(client, url, pin)


def test_a_robot_at_work_is_not_called_away_and_that_is_told(client: InProcessClient) -> None:
    rooms = walls(["#" * 12, *["#....#.....#", "#..........#"] * 1, "#....#.....#", "#" * 12])
    team = ScriptedFleet(
        [Robot("e", "explorer", (2.5, 2.5)), Robot("c", "clearer", (3.5, 2.5))],
        [HiddenBlockade("b", ((5.5, 2.0), (5.5, 3.0)), clear_duration_s=30.0)],
    )
    body = team.mission(rooms, [(9.5, 2.5)], strategy="planner", planning=BRIEF)
    url = client.post("/v1/missions", json=body).headers["location"]
    for _ in range(20):
        tell(client, url, team)
        team.step()
        if team.robots[1].state == "clearing":
            break
    tell(client, url, team)
    where = instruct(client, url, kind="forbid", robot="c", location="b")
    assert "c is at work there until" in remark(client, url, where)
    assert drive(client, url, team) == "completed"


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_where_nothing_can_be_planned_the_reason_is_told(
    client: InProcessClient, strategy: str
) -> None:
    url, _ = begun(client, strategy=strategy)
    priority = instruct(client, url, kind="priority", target="target_1", priority=1)
    instruct(client, url, kind="take-over", robot="left")
    assert client.get(url).json()["status"] == "delayed"
    assert remark(client, url, priority).startswith("nothing can be planned")


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_robot_stops_rather_than_go_where_it_shall_not(
    client: InProcessClient, strategy: str
) -> None:
    url, team = begun(client, strategy=strategy)
    for target in ("target_1", "target_2"):
        client.delete(f"{url}/targets/{target}", headers=WAIT)
    assert goals(tell(client, url, team)) == {"left": "target_3"}
    where = instruct(client, url, kind="forbid", robot="left", location="target_3")
    answer = tell(client, url, team)
    assert answer["mission"]["status"] == "delayed"
    assert "target_3" not in goals(answer).values()
    client.delete(where, headers=WAIT)
    assert goals(tell(client, url, team)) == {"left": "target_3"}
