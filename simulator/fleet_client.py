"""The fleet's side of the fleet protocol (docs/fleet-protocol.md): what to report, what comes back.

How a request reaches the service, and what to do while it is away, is the matter of whoever
implements `CoordinationService`; `scenarios` plugs in the service's own client.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from simulator.fleet_scenario import Point


class FleetClientError(RuntimeError):
    """The service cannot be reached, or refuses; the message says what to do."""


class CoordinationService(Protocol):
    """A service that speaks the fleet protocol; bodies are its JSON."""

    @property
    def retries(self) -> int:
        """Requests that had to be sent again."""
        ...

    def create_mission(self, request: Mapping[str, Any]) -> str:
        """Creates a mission and returns its id.

        Raises:
            FleetClientError: refused, or the service stays away.
        """
        ...

    def report(self, mission: str, report: Mapping[str, Any]) -> Mapping[str, Any]:
        """Sends a report until it is answered, and returns the answer, after replanning.

        Raises:
            FleetClientError: refused, or the service stays away.
        """
        ...


@dataclass(frozen=True, slots=True)
class Command:
    """A robot's current order."""

    id: str
    robot: str
    kind: str
    location: str | None = None
    partner: str | None = None
    path_m: tuple[Point, ...] = ()
    expected_duration_s: float | None = None
    then: tuple[Command, ...] = ()
    """what the robot does afterwards if it is out of contact when it has finished"""


@dataclass(frozen=True, slots=True)
class MissionState:
    """What the service says of the mission in an answer."""

    status: str
    revision: int
    targets_left: int
    replans: int


@dataclass(frozen=True, slots=True)
class Answer:
    """The answer to a report."""

    mission: MissionState
    commands: tuple[Command, ...]


@dataclass(slots=True)
class FleetClient:
    """Speaks for one fleet in one mission."""

    service: CoordinationService
    mission: str = ""
    sequence: int = 0

    @property
    def retries(self) -> int:
        """Requests that had to be sent again."""
        return self.service.retries

    def create_mission(self, request: Mapping[str, Any]) -> str:
        """Creates the mission and returns its id.

        Raises:
            FleetClientError: refused, or the service stays away.
        """
        self.mission = self.service.create_mission(request)
        return self.mission

    def report(
        self,
        time_s: float,
        robots: Sequence[Mapping[str, Any]],
        blockades: Sequence[Mapping[str, Any]] = (),
        finished: Sequence[Mapping[str, Any]] = (),
        failed: Sequence[Mapping[str, Any]] = (),
        *,
        map_patches: Sequence[Mapping[str, Any]] = (),
    ) -> Answer:
        """Reports and returns the commands; a report has one sequence number however often sent.

        Raises:
            FleetClientError: refused, or the service stays away.
        """
        body = {
            "sequence": self.sequence,
            "time_s": time_s,
            "robots": list(robots),
            "blockades": list(blockades),
            "finished": list(finished),
            "failed": list(failed),
        }
        if map_patches:
            body["map_patches"] = list(map_patches)
        answer = self.service.report(self.mission, body)
        self.sequence += 1
        return _read_answer(answer)


def _read_answer(answer: Mapping[str, Any]) -> Answer:
    try:
        mission = answer["mission"]
        state = MissionState(
            status=str(mission["status"]),
            revision=int(mission["revision"]),
            targets_left=int(mission["targets_left"]),
            replans=int(mission["replans"]),
        )
        return Answer(state, tuple(_read_command(command) for command in answer["commands"]))
    except (KeyError, TypeError, ValueError) as error:
        raise FleetClientError(
            f"the service's answer does not follow the fleet protocol: {error!r}"
        ) from None


def _read_command(command: Mapping[str, Any]) -> Command:
    duration_s = command.get("expected_duration_s")
    return Command(
        id=str(command["id"]),
        robot=str(command["robot"]),
        kind=str(command["kind"]),
        location=command.get("location"),
        partner=command.get("partner"),
        path_m=tuple((float(x), float(y)) for x, y in command.get("path_m") or ()),
        expected_duration_s=None if duration_s is None else float(duration_s),
        then=tuple(
            _read_follow_up(follow_up, str(command["robot"]))
            for follow_up in command.get("then") or ()
        ),
    )


def _read_follow_up(follow_up: Mapping[str, Any], robot: str) -> Command:
    position_m = follow_up.get("position_m")
    return Command(
        id=str(follow_up["id"]),
        robot=robot,
        kind=str(follow_up["kind"]),
        location=follow_up.get("location"),
        partner=follow_up.get("partner"),
        path_m=() if position_m is None else ((float(position_m[0]), float(position_m[1])),),
    )
