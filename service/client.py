"""A typed client of the coordination service.

```python
from service.client import Client

client = Client.at("http://127.0.0.1:8080", key="mk_...")
mission = client.create_mission(request)
answer = client.report(mission.id, report, wait_s=5)
for number, event in client.events(mission.id):
    print(number, event.kind)
```

Messages are those of `service.messages`; members that a newer service adds are passed over. Every
call keeps trying while the service is away, as `Patience` says, and repeats nothing that must not
be done twice: missions, instructions and planning requests carry an `Idempotency-Key`, reports a
sequence number.
"""

import json
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Self, TypeVar

import httpx
from pydantic import BaseModel, TypeAdapter

from service.connection import Connection, Patience, ServiceError
from service.coordination.events import Event, from_json
from service.event_stream import followed, parsed
from service.messages.instruction import Instruction, InstructionStatus
from service.messages.map_grid import MapMessage
from service.messages.mission import MissionRequest, RobotMessage, TargetMessage
from service.messages.plan import KnownMap, MissionDetail, PlanInForce
from service.messages.planning import PlanResult, PlanSubmission
from service.messages.report import MissionSummary, Report, ReportAnswer
from service.messages.resource import (
    DomainUpload,
    DomainVersion,
    MapPair,
    MapVersion,
    MissionUse,
    ResourceSummary,
)

__all__ = ["Client", "Connection", "Patience", "ServiceError"]

M = TypeVar("M", bound=BaseModel)
_MISSION_ENDS = frozenset({"mission-closed"})
_PLAN_ENDS = frozenset({"finished", "failed", "canceled"})


@dataclass(frozen=True, slots=True)
class Client:
    """Speaks to one service."""

    connection: Connection

    @classmethod
    def at(cls, url: str, *, key: str | None = None, patience: Patience | None = None) -> Self:
        """A client of the service at an address."""
        http = httpx.Client(base_url=url)
        return cls(Connection(http, patience or Patience(), key))

    def close(self) -> None:
        """Closes the connections."""
        self.connection.http.close()

    # Missions

    def create_mission(
        self, request: MissionRequest, *, idempotency_key: str | None = None
    ) -> MissionDetail:
        """Creates a mission, once; a key of its own makes that hold across runs of the caller."""
        headers = {"Idempotency-Key": idempotency_key or uuid.uuid4().hex}
        answer = self.connection.send(
            "POST", "/v1/missions", content=request.model_dump_json(), headers=headers
        )
        return _read(MissionDetail, answer)

    def missions(self, limit: int = 100) -> list[MissionSummary]:
        """The latest missions."""
        return _read_list(MissionSummary, self._get(f"/v1/missions?limit={limit}"))

    def mission(self, mission_id: str) -> MissionDetail:
        """A mission in full."""
        return _read(MissionDetail, self._get(f"/v1/missions/{mission_id}"))

    def plan(self, mission_id: str) -> PlanInForce:
        """The plan in force."""
        return _read(PlanInForce, self._get(f"/v1/missions/{mission_id}/plan"))

    def known_map(self, mission_id: str) -> KnownMap:
        """The map as known, with the blockades that are not cleared."""
        return _read(KnownMap, self._get(f"/v1/missions/{mission_id}/map"))

    def report(self, mission_id: str, report: Report, *, wait_s: float = 0.0) -> ReportAnswer:
        """Sends a report until it is answered; the service counts it once."""
        answer = self.connection.send(
            "POST",
            f"/v1/missions/{mission_id}/reports",
            content=report.model_dump_json(exclude_defaults=True),
            wait_s=wait_s,
        )
        return _read(ReportAnswer, answer)

    def cancel(self, mission_id: str) -> MissionDetail:
        """Cancels a mission."""
        return _read(MissionDetail, self.connection.send("DELETE", f"/v1/missions/{mission_id}"))

    def events(self, mission_id: str, after: int | None = None) -> Iterator[tuple[int, Event]]:
        """What happens to a mission, with numbers, until it ends; `after` resumes."""
        last = None if after is None else str(after)
        path = f"/v1/missions/{mission_id}/events"
        for event in followed(self.connection, path, last, _MISSION_ENDS):
            yield int(event.id), from_json(event.data)

    def log(self, mission_id: str) -> list[tuple[int, Event]]:
        """What has happened to a mission so far, with numbers."""
        answer = self._get(f"/v1/missions/{mission_id}/events?follow=false")
        lines = answer.text.split("\n")
        return [(int(event.id), from_json(event.data)) for event in parsed(lines)]

    # People

    def add_robot(
        self, mission_id: str, robot: RobotMessage, *, wait_s: float = 0.0
    ) -> MissionDetail:
        """A robot joins."""
        return self._change(mission_id, "robots", robot, wait_s)

    def remove_robot(self, mission_id: str, robot: str, *, wait_s: float = 0.0) -> MissionDetail:
        """A robot leaves."""
        return self._undo(mission_id, f"robots/{robot}", wait_s)

    def add_target(
        self, mission_id: str, target: TargetMessage, *, wait_s: float = 0.0
    ) -> MissionDetail:
        """One more place to visit."""
        return self._change(mission_id, "targets", target, wait_s)

    def remove_target(self, mission_id: str, target: str, *, wait_s: float = 0.0) -> MissionDetail:
        """One place fewer."""
        return self._undo(mission_id, f"targets/{target}", wait_s)

    def instruct(
        self, mission_id: str, instruction: Instruction, *, wait_s: float = 0.0
    ) -> InstructionStatus:
        """Tells a mission what to do, once; with `wait_s`, its remark tells why it cannot."""
        answer = self.connection.send(
            "POST",
            f"/v1/missions/{mission_id}/instructions",
            content=instruction.model_dump_json(),
            headers={"Idempotency-Key": uuid.uuid4().hex},
            wait_s=wait_s,
        )
        identifier = answer.headers["Location"].rsplit("/", 1)[1]
        given = {one.id: one for one in _read(MissionDetail, answer).instructions}
        if identifier not in given:
            raise ServiceError(f"the instruction {identifier} has been withdrawn already")
        return given[identifier]

    def withdraw(self, mission_id: str, instruction: str, *, wait_s: float = 0.0) -> MissionDetail:
        """An instruction no longer counts."""
        return self._undo(mission_id, f"instructions/{instruction}", wait_s)

    # Planning requests

    def submit(self, request: PlanSubmission, *, wait_s: float = 0.0) -> PlanResult:
        """Hands in a problem; the result so far after `wait_s` at most."""
        answer = self.connection.send(
            "POST",
            "/v1/plans",
            content=request.model_dump_json(exclude_none=True),
            headers={"Idempotency-Key": uuid.uuid4().hex},
            wait_s=wait_s,
        )
        return _read(PlanResult, answer)

    def plan_result(self, plan_id: str) -> PlanResult:
        """What has come of a planning request so far."""
        return _read(PlanResult, self._get(f"/v1/plans/{plan_id}"))

    def plan_events(self, plan_id: str) -> Iterator[dict[str, Any]]:
        """Improving plans as they are found, then how it ended."""
        for event in followed(self.connection, f"/v1/plans/{plan_id}/events", None, _PLAN_ENDS):
            told: dict[str, Any] = json.loads(event.data)
            yield told

    def cancel_plan(self, plan_id: str) -> PlanResult:
        """Stops a planning request; its best plan stays."""
        return _read(PlanResult, self.connection.send("DELETE", f"/v1/plans/{plan_id}"))

    # Domains and maps

    def domains(self) -> list[ResourceSummary]:
        """The domains that the service keeps."""
        return _read_list(ResourceSummary, self._get("/v1/domains"))

    def domain(self, name: str, version: str | None = None) -> DomainVersion:
        """A domain: the current version, or the one that is asked for."""
        return _read(DomainVersion, self._get(_address("domains", name, version)))

    def put_domain(
        self, name: str, upload: DomainUpload, *, if_match: str | None = None
    ) -> DomainVersion:
        """Uploads a domain; with `if_match` only if that version is current (412 otherwise)."""
        body = upload.model_dump_json(exclude_unset=True)
        return _read(DomainVersion, self._put("domains", name, body, if_match))

    def maps(self) -> list[ResourceSummary]:
        """The maps that the service keeps."""
        return _read_list(ResourceSummary, self._get("/v1/maps"))

    def map(self, name: str, version: str | None = None) -> MapVersion:
        """A map: the current version, or the one that is asked for."""
        return _read(MapVersion, self._get(_address("maps", name, version)))

    def put_map(
        self, name: str, upload: MapMessage | MapPair, *, if_match: str | None = None
    ) -> MapVersion:
        """Uploads a map; with `if_match` only if that version is current (412 otherwise)."""
        return _read(MapVersion, self._put("maps", name, upload.model_dump_json(), if_match))

    def uses(self, plural: str, name: str) -> list[MissionUse]:
        """The missions that use a version of one of the `domains` or `maps`."""
        return _read_list(MissionUse, self._get(f"/v1/{plural}/{name}/missions"))

    def _get(self, path: str) -> httpx.Response:
        return self.connection.send("GET", path)

    def _put(self, plural: str, name: str, body: str, if_match: str | None) -> httpx.Response:
        headers = {} if if_match is None else {"If-Match": f'"{if_match}"'}
        # Sent twice, a conditional upload would meet itself: the second one finds another version.
        return self.connection.send(
            "PUT",
            f"/v1/{plural}/{name}",
            content=body,
            headers=headers,
            repeatable=if_match is None,
        )

    def _change(self, mission_id: str, part: str, body: BaseModel, wait_s: float) -> MissionDetail:
        answer = self.connection.send(
            "POST",
            f"/v1/missions/{mission_id}/{part}",
            content=body.model_dump_json(),
            wait_s=wait_s,
            repeatable=False,
        )
        return _read(MissionDetail, answer)

    def _undo(self, mission_id: str, part: str, wait_s: float) -> MissionDetail:
        path = f"/v1/missions/{mission_id}/{part}"
        return _read(MissionDetail, self.connection.send("DELETE", path, wait_s=wait_s))


def _address(plural: str, name: str, version: str | None) -> str:
    return f"/v1/{plural}/{name}" + ("" if version is None else f"/versions/{version}")


def _read(model: type[M], answer: httpx.Response) -> M:
    try:
        return model.model_validate_json(answer.content, extra="ignore")
    except ValueError as error:
        raise ServiceError(
            f"the answer to {answer.request.method} {answer.request.url.path} does not follow the "
            f"protocol: {error}"
        ) from None


def _read_list(model: type[M], answer: httpx.Response) -> list[M]:
    adapter: TypeAdapter[list[M]] = TypeAdapter(list[model])  # type: ignore[valid-type]
    try:
        return adapter.validate_json(answer.content, extra="ignore")
    except ValueError as error:
        raise ServiceError(
            f"the answer to {answer.request.method} {answer.request.url.path} does not follow the "
            f"protocol: {error}"
        ) from None
