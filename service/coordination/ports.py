"""What the coordination loop needs of the rest of the service."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

from opentelemetry.trace import Tracer

from service.coordination.deliberation import Decided, Deliberation
from service.coordination.events import Event
from service.messages.mission import CreateMission, MissionRequest
from service.messages.resource import UsedResource

Fault = tuple[str, str]
"""JSON pointer and message."""


class StoreError(Exception):
    """The event log refused; as far as it knows, nothing of this append was written."""


class KeyReusedError(Exception):
    """An idempotency key came with two different requests."""


class EventLog(Protocol):
    """Where events are kept; `append` returns when they are on disk."""

    async def append(self, mission_id: str, first_number: int, events: Sequence[Event]) -> None:
        """Stores consecutive events of a mission, numbered from `first_number`."""
        ...

    def events(self, mission_id: str) -> Iterable[Event]:
        """A mission's events in order."""
        ...


@dataclass(frozen=True)
class ResolvedMission:
    """A mission with the versions of domain and map that it keeps."""

    request: CreateMission
    domain_text: str
    used: tuple[UsedResource, ...]


class UnresolvedError(Exception):
    """A mission or planning request that names what is not there."""

    def __init__(self, faults: list[Fault]) -> None:
        super().__init__(faults[0][1])
        self.faults = faults


class Resources(Protocol):
    """What domains and maps are called."""

    async def mission(self, request: MissionRequest) -> ResolvedMission:
        """A mission with its domain and map.

        Raises:
            UnresolvedError: it names what is not there.
        """
        ...


class Observer(Protocol):
    """Hears of what the loop does, to measure it."""

    tracer: Tracer
    """Opens spans."""

    def noticed(self, count: int) -> None:
        """Facts came in that ask for a replan."""
        ...

    def replanned(self, outcome: str, duration_s: float, makespan_s: float | None) -> None:
        """A replan has ended."""
        ...


class PlannersLostError(Exception):
    """A decision was not made: its workers were killed, crashed or took too long."""


class Planners(Protocol):
    """Where decisions are made, away from the event loop."""

    async def decide(self, deliberation: Deliberation) -> Decided:
        """The decision, computed elsewhere.

        Raises:
            NoPlanError: there is nothing that the team can do.
            PlannersLostError: no worker lived long enough.
        """
        ...

    def forget(self, mission_id: str) -> None:
        """A mission has ended."""
        ...

    @property
    def share_s(self) -> float:
        """Time for each decision so that all missions get theirs soon [s]."""
        ...
