"""The whole loop over HTTP, with a fleet in plain geometry."""

import pytest
from in_process import InProcessClient, serving
from scripted_fleet import HiddenBlockade, Robot, ScriptedFleet, walls

from service.app import create_app
from service.settings import Settings

# Two rooms over a corridor; a door each, and one between the rooms.
ROOMS = walls(
    [
        "####################",
        "#........#.........#",
        "#........#.........#",
        "#..................#",
        "#........#.........#",
        "####.#########.#####",
        "#..................#",
        "#..................#",
        "####################",
    ]
)
WAIT = {"Prefer": "wait=30"}


def fleet() -> ScriptedFleet:
    """An explorer and a clearer in the corridor; both doors are blocked and nobody knows."""
    return ScriptedFleet(
        [Robot("explorer_1", "explorer", (2.5, 2.5)), Robot("clearer_1", "clearer", (4.5, 1.5))],
        [
            HiddenBlockade("blockade_1", ((4.0, 3.5), (5.0, 3.5))),
            HiddenBlockade("blockade_2", ((14.0, 3.5), (15.0, 3.5))),
        ],
    )


TARGETS = [(2.5, 6.5), (17.5, 6.5), (17.5, 1.5)]


def settings() -> Settings:
    return Settings(database_url="sqlite://", planning_workers=1)


def drive(client: InProcessClient, url: str, team: ScriptedFleet, steps: int = 400) -> str:
    """Reports and obeys until the mission is over; returns its status."""
    for _ in range(steps):
        answer = client.post(f"{url}/reports", json=team.report(), headers=WAIT)
        assert answer.status_code == 200, answer.text
        body = answer.json()
        if body["mission"]["status"] in ("completed", "failed", "canceled"):
            return str(body["mission"]["status"])
        team.obey(body)
        team.step()
    raise AssertionError(client.get(url).text)


@pytest.mark.parametrize("strategy", ["hungarian", "planner"])
def test_a_mission_meets_blockades_and_is_completed(strategy: str) -> None:
    team = fleet()
    with serving(create_app(settings())) as client:
        created = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS, strategy=strategy))
        assert created.status_code == 201, created.text
        url = created.headers["location"]
        assert created.json()["status"] == "queued"
        assert drive(client, url, team) == "completed"
        mission = client.get(url).json()
    assert {target["visited_by"] for target in mission["targets"]} == {"explorer_1"}
    assert {blockade["cleared_by"] for blockade in mission["blockades"]} == {"clearer_1"}
    assert any("blockade_1 seen" in decision["reason"] for decision in mission["decisions"])
    closing = [d for d in mission["decisions"] if d["kind"] in ("completed", "failed", "canceled")]
    assert len(closing) == 1
    deeds = [(kind, place) for _, kind, place in team.executed if kind in ("explore", "clear")]
    assert len(deeds) == len(set(deeds))


def test_the_same_fleet_gets_the_same_commands_again() -> None:
    executed = []
    for _ in range(2):
        team = fleet()
        with serving(create_app(settings())) as client:
            url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
            drive(client, url, team)
        executed.append(team.executed)
    assert executed[0] == executed[1]


def test_a_command_keeps_its_id_while_the_order_stays() -> None:
    team = fleet()
    with serving(create_app(settings())) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        seen: dict[tuple[str, str | None], set[str]] = {}
        for _ in range(12):
            answer = client.post(f"{url}/reports", json=team.report(), headers=WAIT).json()
            for command in answer["commands"]:
                if command["kind"] == "explore":
                    seen.setdefault((command["robot"], command["location"]), set()).add(
                        command["id"]
                    )
            team.obey(answer)
            team.step()
    assert seen
    assert all(len(ids) == 1 for ids in seen.values())


def test_plan_and_map_show_what_is_known() -> None:
    team = fleet()
    with serving(create_app(settings())) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        assert client.get(f"{url}/plan").json()["steps"] == []
        before = client.get(f"{url}/map").json()
        for _ in range(3):
            team.obey(client.post(f"{url}/reports", json=team.report(), headers=WAIT).json())
            team.step()
        plan = client.get(f"{url}/plan").json()
        after = client.get(f"{url}/map").json()
    assert plan["revision"] >= 1
    assert {step["action"] for step in plan["steps"]} <= {"explore", "move", "clear"}
    assert plan["makespan_s"] >= max(step["start_s"] for step in plan["steps"])
    assert [blockade["id"] for blockade in after["blockades"]] == ["blockade_1"]
    assert before["cells"] != after["cells"]
