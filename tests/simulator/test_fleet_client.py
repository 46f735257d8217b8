"""What a fleet reports, and what it makes of the answers."""

from collections.abc import Mapping
from typing import Any

import pytest

from simulator.fleet_client import FleetClient, FleetClientError

MISSION = {"status": "underway", "revision": 3, "targets_left": 2, "replans": 1}
ANSWER = {
    "mission": MISSION,
    "commands": [
        {"id": "r3-e", "robot": "e", "kind": "explore", "location": "t", "path_m": [[0, 1], [2, 3]]}
    ],
}


class Service:
    """Answers every report alike; away as often as `absences` says."""

    retries = 7

    def __init__(self, answer: Mapping[str, Any], absences: int = 0) -> None:
        self.answer = answer
        self.absences = absences
        self.reports: list[Mapping[str, Any]] = []

    def create_mission(self, request: Mapping[str, Any]) -> str:
        return f"mission of {request['name']}"

    def report(self, mission: str, report: Mapping[str, Any]) -> Mapping[str, Any]:
        assert mission == "mission of test"
        self.reports.append(report)
        if len(self.reports) <= self.absences:
            raise FleetClientError("away")
        return self.answer


def begun(service: Service) -> FleetClient:
    client = FleetClient(service)
    client.create_mission({"name": "test"})
    return client


def test_commands_come_as_values() -> None:
    answer = begun(Service(ANSWER)).report(1.0, [])
    (command,) = answer.commands
    assert command.path_m == ((0.0, 1.0), (2.0, 3.0))
    assert (command.kind, command.location, command.partner) == ("explore", "t", None)
    assert answer.mission.targets_left == 2


def test_a_report_that_was_not_answered_keeps_its_number() -> None:
    service = Service(ANSWER, absences=1)
    client = begun(service)
    with pytest.raises(FleetClientError):
        client.report(1.0, [])
    client.report(1.0, [])
    client.report(2.0, [])
    assert [report["sequence"] for report in service.reports] == [0, 0, 1]
    assert client.retries == 7


def test_an_answer_of_another_protocol_is_refused() -> None:
    with pytest.raises(FleetClientError, match="does not follow the fleet protocol"):
        begun(Service({"hello": 1})).report(1.0, [])
