"""The executor port on workers that are processes, wherever they run.

A worker that is killed or crashes costs the one piece of work it was at and is replaced at once.
Work goes first to a worker that is warm for it, and after some patience to any.
"""

import asyncio
import logging
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Protocol

from service.jobs.executor import LAST, Capacity, QueueFullError, Told, Work
from service.jobs.fair_queue import FairQueue
from service.jobs.parcels import Dispatching

LOG = logging.getLogger(__name__)
HIRE_AGAIN_S = 1.0
"""When to try again after a worker could not be started."""


class Worker(Protocol):
    """A process that computes, and can be ended by force."""

    async def send(self, parcel: bytes) -> None:
        """Hands it work; a dead worker is noticed on hearing."""
        ...

    async def hear(self) -> Told:
        """The next thing it tells; that it crashed, if it did."""
        ...

    def kill(self) -> None:
        """Ends the process at once."""
        ...


@dataclass(frozen=True)
class PoolParameters:
    """Sizes and limits of a pool."""

    workers: int = 2
    queue_limit: int = 100
    """Pieces of work that wait at most."""
    memory_limit_mb: int = 4096
    """Address space of a worker, its libraries included [MiB]."""
    patience_s: float = 0.2
    """How long work waits for a worker that is warm for it, while others are idle."""


@dataclass(eq=False)
class PooledRun:
    """Work in the pool."""

    work: Work
    pool: "WorkerPool"
    since_s: float = field(default_factory=time.monotonic)
    news: "asyncio.Queue[Told]" = field(default_factory=asyncio.Queue)
    canceled: asyncio.Event = field(default_factory=asyncio.Event)

    async def told(self) -> AsyncIterator[Told]:
        """What the worker tells, until the work ends."""
        while True:
            told = await self.news.get()
            yield told
            if told["kind"] in LAST:
                return

    def cancel(self) -> None:
        """Stops it at once and frees its worker."""
        if self.pool.withdraw(self):
            self.news.put_nowait({"kind": "canceled"})
        self.canceled.set()


@dataclass(eq=False)
class Seat:
    """A worker and what it is known to keep."""

    worker: Worker
    dispatching: Dispatching = field(default_factory=Dispatching)
    is_idle: bool = True
    heard: "asyncio.Task[Told] | None" = None
    """Listens also while the worker is idle: if it tells something then, it has died."""


class WorkerPool:
    """The `Executor` port."""

    def __init__(
        self,
        parameters: PoolParameters,
        hire: Callable[[], Awaitable[Worker]],
        waited: Callable[[float], None] = lambda _: None,
    ) -> None:
        """A pool without workers yet.

        Args:
            hire: starts a worker.
            waited: hears how long each piece of work waited [s].
        """
        self._parameters = parameters
        self._hire = hire
        self._waited = waited
        self._queue: FairQueue[PooledRun] = FairQueue()
        self._changed = asyncio.Event()
        self._running = 0
        self._restarts = 0
        self._draining = False
        self._slots: list[asyncio.Task[None]] = []
        self._seats: set[Seat] = set()

    def warm_up(self) -> None:
        """Starts all workers before there is work."""
        while len(self._slots) < self._parameters.workers:
            self._slots.append(asyncio.get_running_loop().create_task(self._slot()))

    def submit(self, work: Work, *, client: str, priority: int) -> PooledRun:
        """Takes work on.

        Raises:
            QueueFullError: the queue is full, or the pool is being drained.
        """
        if self._draining:
            raise QueueFullError("the service is shutting down")
        if len(self._queue) >= self._parameters.queue_limit:
            raise QueueFullError(f"{len(self._queue)} requests are waiting")
        run = PooledRun(work, self)
        self._queue.put(run, client=client, priority=priority)
        self._notify()
        wanted = min(len(self._queue) + self._running, self._parameters.workers)
        if len(self._slots) < wanted:
            self._slots.append(asyncio.get_running_loop().create_task(self._slot()))
        return run

    def withdraw(self, run: PooledRun) -> bool:
        """Takes work out of the queue; false if it is not waiting any more."""
        return self._queue.remove(run)

    def forget(self, affinity: str) -> None:
        """There will be no more work of this affinity."""
        for seat in self._seats:
            seat.dispatching.forget(affinity)

    def capacity(self) -> Capacity:
        """What is running and waiting now."""
        return Capacity(
            self._parameters.workers,
            self._running,
            len(self._queue),
            self._restarts,
            full=self._draining or len(self._queue) >= self._parameters.queue_limit,
        )

    def workers(self) -> list[Worker]:
        """Those that are alive."""
        return [seat.worker for seat in self._seats]

    async def drain(self, timeout_s: float) -> None:
        """Takes nothing more on and waits for what is running, but not longer than that."""
        self._draining = True
        deadline_s = time.monotonic() + timeout_s
        while self._running and time.monotonic() < deadline_s:
            changed = self._changed
            with suppress(TimeoutError):
                await asyncio.wait_for(changed.wait(), max(deadline_s - time.monotonic(), 0.0))

    async def close(self) -> None:
        """Kills all workers."""
        self._draining = True
        for slot in self._slots:
            slot.cancel()
        await asyncio.gather(*self._slots, return_exceptions=True)

    def _notify(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()

    # A slot: one worker after another, one piece of work after another.

    async def _slot(self) -> None:
        while True:
            try:
                seat = Seat(await self._hire())
            except Exception:
                LOG.exception("a planning worker could not be started; trying again")
                await asyncio.sleep(HIRE_AGAIN_S)
                continue
            self._seats.add(seat)
            try:
                while await self._work_once(seat):
                    pass
                self._restarts += 1
            finally:
                self._seats.discard(seat)
                if seat.heard is not None:
                    seat.heard.cancel()
                    await asyncio.gather(seat.heard, return_exceptions=True)
                seat.worker.kill()

    async def _work_once(self, seat: Seat) -> bool:
        """Whether the worker is fit for more."""
        seat.is_idle = True
        run = await self._next(seat)
        if run is None:
            LOG.warning("an idle planning worker has died; another takes its place")
            return False
        seat.is_idle = False
        self._running += 1
        self._waited(time.monotonic() - run.since_s)
        try:
            return await self._serve(seat, run)
        finally:
            self._running -= 1
            self._notify()

    async def _next(self, seat: Seat) -> PooledRun | None:
        """The next work for a worker; None if it has died."""
        while True:
            changed = self._changed
            if not self._draining:
                with suppress(IndexError):
                    return self._queue.take(lambda run: self._suits(seat, run))
            if seat.heard is None:
                seat.heard = asyncio.get_running_loop().create_task(seat.worker.hear())
            news = asyncio.get_running_loop().create_task(changed.wait())
            try:
                await asyncio.wait(
                    (seat.heard, news),
                    timeout=self._parameters.patience_s if len(self._queue) else None,
                    return_when=asyncio.FIRST_COMPLETED,
                )
            finally:
                news.cancel()
            if seat.heard.done():
                return None

    def _suits(self, seat: Seat, run: PooledRun) -> bool:
        """Whether this worker shall take the work now rather than leave it to a better one."""
        affinity = run.work.affinity
        if affinity is None or seat.dispatching.is_warm(affinity):
            return True
        others = [other for other in self._seats if other is not seat]
        if any(other.dispatching.is_warm(affinity) for other in others):
            return time.monotonic() - run.since_s >= self._parameters.patience_s
        kept = len(seat.dispatching.memories)
        return not any(o.is_idle and len(o.dispatching.memories) < kept for o in others)

    async def _serve(self, seat: Seat, run: PooledRun) -> bool:
        """Whether the worker is fit for more."""
        if run.canceled.is_set():
            run.news.put_nowait({"kind": "canceled"})
            return True
        loop = asyncio.get_running_loop()
        deadline_s = loop.time() + run.work.hard_limit_s
        try:
            await asyncio.wait_for(
                seat.worker.send(seat.dispatching.pack(run.work)), run.work.hard_limit_s
            )
        except TimeoutError:
            run.news.put_nowait(_overrun(run.work))
            return False
        canceled = loop.create_task(run.canceled.wait())
        if seat.heard is None:
            seat.heard = loop.create_task(seat.worker.hear())
        try:
            while True:
                await asyncio.wait(
                    (seat.heard, canceled),
                    timeout=max(deadline_s - loop.time(), 0.0),
                    return_when=asyncio.FIRST_COMPLETED,
                )
                if canceled.done() or not seat.heard.done():
                    ending = {"kind": "canceled"} if canceled.done() else _overrun(run.work)
                    run.news.put_nowait(ending)
                    return False
                told, seat.heard = seat.heard.result(), None
                run.news.put_nowait(told)
                if told["kind"] in LAST:
                    return told.get("outcome") != "crashed"
                seat.heard = loop.create_task(seat.worker.hear())
        finally:
            canceled.cancel()


def _overrun(work: Work) -> Told:
    return {
        "kind": "failed",
        "outcome": "timed_out",
        "message": f"stopped by force after {work.hard_limit_s:g} s",
    }
