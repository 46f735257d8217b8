"""Commands over a real WebSocket: pushed, in answer to reports, refused with reasons."""

import json
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from httpx_ws import WebSocketDisconnect, WebSocketSession, WebSocketUpgradeError, connect_ws
from test_access import KEYS, by
from test_client import listening
from test_mission_loop import ROOMS, TARGETS, fleet

from service.access import ApiKey, digest
from service.settings import Settings


@pytest.fixture(scope="module")
def http() -> Iterator[httpx.Client]:
    scopes: dict[str, list[Any]] = {
        "viewer": ["read"],
        "north": ["read", "operate"],
        "chief": ["read", "operate", "edit"],
    }
    keys = [
        ApiKey(
            name=name,
            sha256=digest(KEYS[name]),
            scopes=scopes[name],
            fleets=["north"] if name == "north" else ["*"],
        )
        for name in scopes
    ]
    settings = Settings(database_url="sqlite://", api_keys=keys, max_body_bytes=200_000)
    with (
        listening(settings) as port,
        httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=30.0) as client,
    ):
        yield client


def created(http: httpx.Client, **more: Any) -> str:
    body = fleet().mission(ROOMS, TARGETS, **more)
    return http.post("/v1/missions", json=body, headers=by("chief")).headers["location"]


def heard(socket: WebSocketSession) -> dict[str, Any]:
    frame: dict[str, Any] = json.loads(socket.receive_text(timeout=20.0))
    return frame


def heard_to_the_end(socket: WebSocketSession) -> None:
    while heard(socket)["mission"]["status"] == "completed":
        pass


def test_a_mission_is_driven_over_a_socket(http: httpx.Client) -> None:
    url = created(http)
    team = fleet()
    with connect_ws(f"{url}/commands", http, headers=by("chief")) as socket:
        frame = heard(socket)
        assert frame["kind"] == "commands"
        assert frame["mission"]["status"] == "queued"
        assert frame["commands"] == []
        for _ in range(400):
            report = team.report()
            socket.send_text(json.dumps(report))
            frame = heard(socket)
            while frame["mission"]["sequence"] < report["sequence"]:
                frame = heard(socket)
            if frame["mission"]["status"] == "completed":
                break
            # Orders that come later are pushed; for the test, wait for the replan by HTTP.
            again = http.post(
                f"{url}/reports", json=report, headers={**by("chief"), "Prefer": "wait=10"}
            ).json()
            status = again["mission"]["status"]
            while frame["commands"] != again["commands"] or frame["mission"]["status"] != status:
                frame = heard(socket)
            if frame["mission"]["status"] == "completed":
                break
            team.obey(frame)
            team.step()
        with pytest.raises(WebSocketDisconnect) as closed:
            heard_to_the_end(socket)
    assert closed.value.code == 1000
    assert http.get(url, headers=by("viewer")).json()["status"] == "completed"


def test_what_is_wrong_with_a_report_is_told(http: httpx.Client) -> None:
    url = created(http)
    with connect_ws(f"{url}/commands", http, headers=by("chief")) as socket:
        heard(socket)
        for sent, status, where in (
            ("not json", 400, ""),
            ("{}", 422, "/sequence"),
            ('{"sequence": 0, "time_s": 0, "robots": [{"id": "nobody", "pose": [1, 1, 0], '
             '"state": "idle"}]}', 422, "/robots/0/id"),
            (json.dumps({"sequence": 0, "time_s": 0, "x": "y" * 300_000}), 413, None),
        ):  # fmt: skip
            socket.send_text(sent)
            frame = heard(socket)
            assert (frame["kind"], frame["status"]) == ("problem", status)
            if where is not None:
                assert frame["errors"][0]["location"] == where
        socket.send_text('{"sequence": 0, "time_s": 0}')
        assert heard(socket)["kind"] == "commands"


def test_a_viewer_watches_and_does_not_report(http: httpx.Client) -> None:
    url = created(http)
    with connect_ws(f"{url}/commands", http, headers=by("viewer")) as socket:
        heard(socket)
        socket.send_text('{"sequence": 0, "time_s": 0}')
        assert heard(socket)["status"] == 403
        http.delete(url, headers=by("chief"))
        assert heard(socket)["mission"]["status"] == "canceled"


@pytest.mark.parametrize(
    ("who", "fleet_name", "status"),
    [(None, "north", 401), ("north", "south", 404), ("north", "north", 101)],
)
def test_who_is_let_in(http: httpx.Client, who: str | None, fleet_name: str, status: int) -> None:
    url = created(http, fleet=fleet_name)
    headers = {} if who is None else by(who)
    if status == 101:
        with connect_ws(f"{url}/commands", http, headers=headers) as socket:
            assert heard(socket)["kind"] == "commands"
    else:
        with (
            pytest.raises(WebSocketUpgradeError) as refused,
            connect_ws(f"{url}/commands", http, headers=headers),
        ):
            pass
        assert refused.value.response.status_code == status
