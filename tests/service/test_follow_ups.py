"""Robots out of contact: what they are told to do next, and what becomes of what they did."""

from dataclasses import replace
from typing import Any

from corridor import corridor
from in_process import InProcessClient, serving
from scripted_fleet import Robot, ScriptedFleet, walls
from test_mission_loop import WAIT

from domains.formulation import OrderKind
from semantic_attachments.contract import Memory
from service.app import create_app
from service.coordination.strategies import all_strategies
from service.settings import Settings

HALL = walls(["#" * 42, *["#" + "." * 40 + "#"] * 4, "#" * 42])
STRATEGIES = all_strategies()
BLOCKADE = {"id": "b", "segment_m": [[30.5, 1.0], [30.5, 5.0]], "clear_duration_s": 10.0}


def test_the_planners_robots_know_the_rest_of_their_tour() -> None:
    situation = corridor({"e": 2.0}, {}, {"near": 8.0, "mid": 20.0, "far": 35.0})
    ahead = replace(situation, commands_ahead=5)
    proposal = STRATEGIES["planner"].propose(ahead, Memory())
    assert [a.location for a in proposal.assignments] == ["near"]
    assert [(a.kind, a.location) for a in proposal.then["e"]] == [
        (OrderKind.EXPLORE, "mid"),
        (OrderKind.EXPLORE, "far"),
    ]
    assert STRATEGIES["planner"].propose(situation, Memory()).then == {}


def test_nothing_follows_where_a_robot_waits_for_another() -> None:
    """Beyond the blockade the explorer has to wait for the clearer."""
    situation = corridor(
        {"e": 12.0}, {"c": 2.0}, {"near": 14.0, "beyond": 36.0}, blockades={"b": 30.0}
    )
    then = STRATEGIES["planner"].propose(replace(situation, commands_ahead=5), Memory()).then
    assert "beyond" not in [a.location for a in then.get("e", ())]
    assert [a.kind for a in then["c"]] == [OrderKind.CLEAR]


def test_a_clearer_sent_by_the_hungarian_method_clears_on_arrival() -> None:
    situation = corridor({"e": 4.0}, {"c": 2.0}, {"beyond": 36.0}, blockades={"b": 30.0})
    then = STRATEGIES["hungarian"].propose(replace(situation, commands_ahead=1), Memory()).then
    assert [(a.kind, a.location) for a in then["c"]] == [(OrderKind.CLEAR, "b")]


def robot(name: str, x: float, state: str = "idle", command: str | None = None) -> dict[str, Any]:
    return {"id": name, "pose": [x, 3.0, 0.0], "state": state, "command": command}


def begun(client: InProcessClient, **more: Any) -> tuple[str, dict[str, Any]]:
    """A mission with a blockade known, and its first commands by robot."""
    team = ScriptedFleet([Robot("e", "explorer", (2.5, 3.0)), Robot("c", "clearer", (4.5, 3.0))])
    body = team.mission(HALL, [(20.5, 3.0), (38.5, 3.0)], commands_ahead=4, **more)
    url = client.post("/v1/missions", json=body).headers["location"]
    answer = tell(
        client, url, 0, 0.0, robots=[robot("e", 2.5), robot("c", 4.5)], blockades=[BLOCKADE]
    )
    return url, answer


def tell(
    client: InProcessClient, url: str, sequence: int, time_s: float, **more: Any
) -> dict[str, Any]:
    body = {"sequence": sequence, "time_s": time_s, "robots": [], **more}
    answer = client.post(f"{url}/reports", json=body, headers=WAIT)
    assert answer.status_code == 200, answer.text
    return {command["robot"]: command for command in answer.json()["commands"]}


def test_what_was_done_out_of_contact_counts_with_its_time_and_place() -> None:
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        url, commands = begun(client)
        moves = commands["c"]
        assert (moves["kind"], moves["location"]) == ("move", "b")
        (clears,) = moves["then"]
        assert (clears["kind"], clears["location"]) == ("clear", "b")
        for step in range(1, 12):
            tell(client, url, step, 5.0 * step)
        now = tell(
            client,
            url,
            12,
            60.0,
            robots=[robot("c", 12.0), robot("e", 10.0)],
            finished=[
                {"robot": "c", "command": moves["id"], "time_s": 26.0, "position_m": [29.6, 3.0]},
                {"robot": "c", "command": clears["id"], "time_s": 36.0, "position_m": [29.6, 3.0]},
                {
                    "robot": "e",
                    "command": commands["e"]["id"],
                    "time_s": 20.0,
                    "position_m": [20.5, 3.0],
                },
            ],
        )
        mission = client.get(url).json()
    assert mission["blockades"][0]["cleared_by"] == "c"
    assert mission["blockades"][0]["cleared_at_s"] == 36.0
    visited = {t["id"]: t["visited_at_s"] for t in mission["targets"]}
    assert visited == {"target_1": 20.0, "target_2": None}
    # It is planned from where the robots are, not from where they were then.
    assert now["e"]["location"] == "target_2"
    assert now["e"]["path_m"][0][0] < 12.0


def test_a_robot_that_has_gone_on_by_itself_keeps_what_it_is_at() -> None:
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        url, commands = begun(client)
        (clears,) = commands["c"]["then"]
        now = tell(
            client,
            url,
            1,
            27.0,
            robots=[{**robot("c", 29.6, "clearing", clears["id"]), "busy_until_s": 36.0}],
            finished=[{"robot": "c", "command": commands["c"]["id"]}],
        )
        assert now["c"]["id"] == clears["id"]
        assert now["c"]["kind"] == "clear"


def test_silence_is_not_standing_still() -> None:
    """A robot on a long way out of contact keeps its command; the lease decides when it is lost."""
    with serving(create_app(Settings(database_url="sqlite://", give_up_s=20.0))) as client:
        url, commands = begun(client, lease_s=300.0)
        for step in range(1, 50):
            tell(client, url, step, 5.0 * step, robots=[robot("c", 4.5)])
        mission = client.get(url).json()
        kinds = [(d["kind"], d["reason"]) for d in mission["decisions"]]
        assert not [r for k, r in kinds if k == "command failed" and r.startswith("e ")]
        assert not [r for k, r in kinds if k == "robot lost"]
        for step in range(50, 70):
            tell(client, url, step, 5.0 * step, robots=[robot("c", 4.5)])
        lost = [d for d in client.get(url).json()["decisions"] if d["kind"] == "robot lost"]
    assert [d["reason"] for d in lost] == ["e fell silent"]
    assert lost[0]["time_s"] > 300.0
    assert commands["e"]["kind"] == "explore"
