"""The recorder turns reports and answers into what each robot did."""

import json
from typing import Any

import httpx

from scenarios.mission_record import Activity
from scenarios.recorder import Recorder, RecordingTransport

PLAN = {
    "revision": 1,
    "makespan_s": 30.0,
    "validated": True,
    "steps": [
        {"start_s": 0.0, "action": "explore", "arguments": ["e", "t"], "duration_s": 30.0},
    ],
}


def answer(*commands: dict[str, Any], revision: int = 1) -> dict[str, Any]:
    mission = {"id": "m", "revision": revision, "targets_left": 1, "replans": revision}
    return {"mission": mission, "commands": list(commands)}


def explore(revision: int, target: str) -> dict[str, Any]:
    return {"id": f"r{revision}", "robot": "e", "kind": "explore", "location": target}


def report(time_s: float, state: str = "driving", **more: Any) -> dict[str, Any]:
    return {"time_s": time_s, "robots": [{"id": "e", "state": state}], **more}


def test_stretches_follow_the_commands() -> None:
    recorder = Recorder()
    recorder.reported(report(0.0, "idle"), answer(explore(1, "a")))
    recorder.reported(report(5.0), answer(explore(1, "a")))
    recorder.reported(report(8.0), answer(explore(2, "b"), revision=2))
    done = {"finished": [{"robot": "e", "command": "r2"}]}
    recorder.reported(report(12.0, "idle", **done), answer(explore(2, "b"), revision=2))
    recorder.reported(report(14.0, "idle"), answer())
    assert recorder.activities("e") == (
        Activity("explore", "a", 0.0, 8.0),
        Activity("explore", "b", 8.0, 12.0),
        Activity("wait", None, 12.0, 14.0),
    )


def test_a_blockade_is_known_from_its_first_report() -> None:
    recorder = Recorder()
    recorder.reported(report(3.0, blockades=[{"id": "b"}]), answer())
    recorder.reported(report(4.0, blockades=[{"id": "b"}]), answer())
    assert recorder.seen_at_s == {"b": 3.0}


def test_transport_listens_and_fetches_each_new_plan_once() -> None:
    asked: list[str] = []

    def service(request: httpx.Request) -> httpx.Response:
        asked.append(f"{request.method} {request.url.path}")
        if request.url.path.endswith("/plan"):
            return httpx.Response(200, json=PLAN)
        if request.url.path.endswith("/reports"):
            return httpx.Response(200, json=answer(explore(1, "t")))
        return httpx.Response(201, json={"id": "m"})

    recorder = Recorder()
    transport = RecordingTransport(httpx.MockTransport(service), recorder)
    with httpx.Client(transport=transport, base_url="http://s") as client:
        client.post("/v1/missions", json={})
        for time_s in (0.0, 1.0):
            got = client.post("/v1/missions/m/reports", content=json.dumps(report(time_s)))
            assert got.json()["mission"]["targets_left"] == 1
    assert recorder.mission == {"id": "m"}
    assert [plan.revision for plan in recorder.plans] == [1]
    assert asked.count("GET /v1/missions/m/plan") == 1


def test_refused_reports_are_not_recorded() -> None:
    recorder = Recorder()
    refusing = httpx.MockTransport(lambda _: httpx.Response(422, json={}))
    with httpx.Client(transport=RecordingTransport(refusing, recorder)) as client:
        client.post("http://s/v1/missions/m/reports", json=report(1.0))
    assert recorder.answer is None
