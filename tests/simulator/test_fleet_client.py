from collections.abc import Callable

import httpx
import pytest

from simulator.fleet_client import FleetClient, FleetClientError, Patience

MISSION = {"status": "underway", "revision": 3, "targets_left": 2, "replans": 1}
ANSWER = {
    "mission": MISSION,
    "commands": [
        {"id": "r3-e", "robot": "e", "kind": "explore", "location": "t", "path_m": [[0, 1], [2, 3]]}
    ],
}


class Wall:
    """A clock that only sleeping moves."""

    def __init__(self) -> None:
        self.time_s = 0.0

    def sleep(self, seconds: float) -> None:
        self.time_s += seconds

    def now(self) -> float:
        return self.time_s


def client_for(handler: Callable[[httpx.Request], httpx.Response]) -> tuple[FleetClient, Wall]:
    wall = Wall()
    http = httpx.Client(transport=httpx.MockTransport(handler), base_url="http://service")
    return FleetClient(http, Patience(), wall.sleep, wall.now, mission="m1"), wall


def test_commands_come_as_values() -> None:
    client, _ = client_for(lambda _: httpx.Response(200, json=ANSWER))
    answer = client.report(1.0, [])
    (command,) = answer.commands
    assert command.path_m == ((0.0, 1.0), (2.0, 3.0))
    assert (command.kind, command.location, command.partner) == ("explore", "t", None)
    assert answer.mission.targets_left == 2


def test_a_lost_answer_is_asked_for_again_with_the_same_sequence() -> None:
    seen: list[bytes] = []

    def handler(request: httpx.Request) -> httpx.Response:
        seen.append(request.content)
        if len(seen) == 1:
            raise httpx.ConnectError("refused")
        if len(seen) == 2:
            return httpx.Response(503, headers={"Retry-After": "3"})
        return httpx.Response(200, json=ANSWER)

    client, wall = client_for(handler)
    client.report(1.0, [])
    assert seen[0] == seen[1] == seen[2]
    assert (client.retries, client.sequence) == (2, 1)
    assert wall.time_s >= 3.0


def test_a_service_that_stays_away_is_given_up_with_a_remedy() -> None:
    def handler(_: httpx.Request) -> httpx.Response:
        raise httpx.ConnectError("refused")

    client, wall = client_for(handler)
    with pytest.raises(FleetClientError, match="start it with `marsupial serve`"):
        client.report(1.0, [])
    assert wall.time_s <= 60.0


def test_a_refusal_says_where_the_body_is_wrong() -> None:
    problem = {
        "detail": "the mission is malformed",
        "errors": [{"location": "/robots/0/pose", "message": "is inside a wall"}],
    }
    client, _ = client_for(lambda _: httpx.Response(422, json=problem))
    with pytest.raises(FleetClientError, match=r"422\).*/robots/0/pose: is inside a wall"):
        client.create_mission({})


def test_an_answer_of_another_protocol_is_refused() -> None:
    client, _ = client_for(lambda _: httpx.Response(200, json={"hello": 1}))
    with pytest.raises(FleetClientError, match="does not follow the fleet protocol"):
        client.report(1.0, [])
