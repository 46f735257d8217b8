"""The simulated fleet's way to the service: JSON in, JSON out, refusals as the simulator's."""

import json

import httpx
import pytest

from scenarios.service_link import ServiceLink
from simulator.fleet_client import FleetClientError

ANSWER = {
    "mission": {
        "id": "m",
        "status": "underway",
        "revision": 1,
        "sequence": 0,
        "targets_left": 1,
        "replans": 0,
    },
    "commands": [],
}


def test_reports_ask_to_wait_for_the_replan() -> None:
    seen: list[httpx.Request] = []

    def handler(request: httpx.Request) -> httpx.Response:
        seen.append(request)
        return httpx.Response(200, json=ANSWER)

    http = httpx.Client(transport=httpx.MockTransport(handler), base_url="http://s")
    link = ServiceLink(http, key="mk_a")
    answer = link.report("m", {"sequence": 0, "time_s": 1.5, "robots": []})
    assert answer["mission"]["status"] == "underway"
    assert json.loads(seen[0].content) == {"sequence": 0, "time_s": 1.5}
    assert seen[0].headers["prefer"] == "wait=30"
    assert seen[0].headers["authorization"] == "Bearer mk_a"


def test_what_the_service_refuses_the_simulator_is_told() -> None:
    def handler(_: httpx.Request) -> httpx.Response:
        return httpx.Response(404, json={"detail": "there is no mission"})

    http = httpx.Client(transport=httpx.MockTransport(handler), base_url="http://s")
    with pytest.raises(FleetClientError, match="there is no mission"):
        ServiceLink(http).report("m", {"sequence": 0, "time_s": 0.0})
    with pytest.raises(FleetClientError, match="fleet protocol"):
        ServiceLink(http).report("m", {"sequence": 0, "time_s": "now"})
