"""The executor port: where planning requests run."""

from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Protocol

from service.jobs.work import PlanningWork, Told


class QueueFullError(Exception):
    """No more requests are taken on for now."""


@dataclass(frozen=True, slots=True)
class Capacity:
    """What an executor has to offer."""

    workers: int
    running: int
    queued: int
    restarts: int
    """Workers that were killed or crashed and replaced."""
    full: bool = False
    """Whether another request would be refused."""


class Run(Protocol):
    """A request that was taken on."""

    def told(self) -> AsyncIterator[Told]:
        """What the worker tells; the last one is `finished`, `failed` or `canceled`."""
        ...

    def cancel(self) -> None:
        """Stops it at once and frees its worker."""
        ...


class Executor(Protocol):
    """Runs planning requests."""

    def submit(self, work: PlanningWork, *, client: str, priority: int) -> Run:
        """Takes a request on.

        Args:
            client: who asks; clients of the same priority take turns.
            priority: higher goes first.

        Raises:
            QueueFullError: the queue is full.
        """
        ...

    def capacity(self) -> Capacity:
        """What is running and waiting now."""
        ...

    async def close(self) -> None:
        """Stops everything."""
        ...
