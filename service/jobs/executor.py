"""The executor port: where planning runs."""

from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass
from typing import Any, Protocol

from semantic_attachments.contract import Memory

Told = dict[str, Any]
"""What a worker tells: `{"kind": "plan" | "finished" | "failed" | "canceled", ...}`."""

Tell = Callable[[Told], None]

LAST = ("finished", "failed", "canceled")
"""Kinds after which a worker tells no more of a piece of work."""


class QueueFullError(Exception):
    """No more work is taken on for now."""


class Work(Protocol):
    """Something to compute in a worker; it is pickled on its way there."""

    @property
    def hard_limit_s(self) -> float:
        """Wall-clock time after which the worker is ended by force."""
        ...

    @property
    def affinity(self) -> str | None:
        """Work of one affinity shares what attachments keep, if it comes to the same worker."""
        ...

    @property
    def traceparent(self) -> str | None:
        """The span that asks for it (W3C Trace Context)."""
        ...

    def answer(self, tell: Tell, memory: Memory) -> None:
        """Computes, in the worker; the last thing told is `finished` or `failed`."""
        ...


@dataclass(frozen=True, slots=True)
class Capacity:
    """What an executor has to offer."""

    workers: int
    running: int
    queued: int
    restarts: int
    """Workers that were killed or crashed and replaced."""
    full: bool = False
    """Whether more work would be refused."""


class Run(Protocol):
    """Work that was taken on."""

    def told(self) -> AsyncIterator[Told]:
        """What the worker tells; the last one is `finished`, `failed` or `canceled`."""
        ...

    def cancel(self) -> None:
        """Stops it at once and frees its worker."""
        ...


class Executor(Protocol):
    """Runs work in workers that it can end by force; a worker that is lost costs its work alone."""

    def submit(self, work: Work, *, client: str, priority: int) -> Run:
        """Takes work on.

        Args:
            client: who asks; clients of the same priority take turns.
            priority: higher goes first.

        Raises:
            QueueFullError: the queue is full, or the executor is being drained.
        """
        ...

    def capacity(self) -> Capacity:
        """What is running and waiting now."""
        ...

    def forget(self, affinity: str) -> None:
        """There will be no more work of this affinity."""
        ...

    async def drain(self, timeout_s: float) -> None:
        """Takes nothing more on and waits for what is running, but not longer than that."""
        ...

    async def close(self) -> None:
        """Stops everything."""
        ...
