"""What the coordination loop needs of the rest of the service."""

from collections.abc import Callable, Iterable, Sequence
from typing import Protocol, TypeVar

from service.coordination.events import Event


class StoreError(Exception):
    """The event log refused; as far as it knows, nothing of this append was written."""


class EventLog(Protocol):
    """Where events are kept; `append` returns when they are on disk."""

    async def append(self, mission_id: str, first_number: int, events: Sequence[Event]) -> None:
        """Stores consecutive events of a mission, numbered from `first_number`."""
        ...

    def events(self, mission_id: str) -> Iterable[Event]:
        """A mission's events in order."""
        ...


A = TypeVar("A")
R = TypeVar("R")


class Observer(Protocol):
    """Hears of what the loop does, to measure it."""

    def noticed(self, count: int) -> None:
        """Facts came in that ask for a replan."""
        ...

    def replanned(self, outcome: str, duration_s: float, makespan_s: float | None) -> None:
        """A replan has ended."""
        ...


class Planners(Protocol):
    """Where strategies run, away from the event loop."""

    async def run(self, function: Callable[[A], R], argument: A) -> R:
        """`function(argument)`, computed elsewhere."""
        ...

    @property
    def load(self) -> float:
        """Computations under way or waiting, for each worker."""
        ...
