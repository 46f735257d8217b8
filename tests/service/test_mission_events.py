"""Events over SSE, resumed where a client left off."""

import json
from typing import Any

from in_process import InProcessClient, serving
from test_mission_loop import ROOMS, TARGETS, drive, fleet

from service.app import create_app
from service.settings import Settings


def stream(client: InProcessClient, url: str, **headers: str) -> list[dict[str, Any]]:
    """The events of a mission that is over: the stream ends by itself."""
    answer = client.get(f"{url}/events", headers=headers)
    assert answer.headers["content-type"].startswith("text/event-stream")
    events = []
    for block in answer.text.strip().split("\n\n"):
        fields = dict(line.split(": ", 1) for line in block.split("\n") if ": " in line)
        if "data" in fields:
            events.append({**fields, "data": json.loads(fields["data"])})
    return events


def test_every_event_is_told_in_order_and_once() -> None:
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        drive(client, url, team)
        events = stream(client, url)
        resumed = stream(client, url, **{"Last-Event-ID": "9"})
        refused = client.get(f"{url}/events", headers={"Last-Event-ID": "yesterday"})
        detail = client.get(url).json()
    assert [int(event["id"]) for event in events] == list(range(len(events)))
    assert events[0]["event"] == "mission-created"
    assert events[-1]["event"] == "mission-closed"
    assert resumed == events[10:]
    assert refused.status_code == 422
    revisions = [e["data"]["revision"] for e in events if e["event"] == "orders-issued"]
    assert revisions == list(range(1, detail["revision"] + 1))


def test_a_listener_hears_of_what_happens_while_it_listens() -> None:
    team = fleet()
    with serving(create_app(Settings(database_url="sqlite://"))) as client:
        url = client.post("/v1/missions", json=team.mission(ROOMS, TARGETS)).headers["location"]
        listening = client.start("GET", f"{url}/events")
        drive(client, url, team)
        heard = listening.result(30.0).text
    assert "event: mission-created" in heard
    assert "event: mission-closed" in heard
