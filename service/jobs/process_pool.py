"""Planning requests in worker processes with hard limits on time and memory.

A worker that is killed or crashes costs the one request it was working on; the next request gets
a new worker. Workers stay warm between requests.
"""

import asyncio
import multiprocessing
from collections.abc import AsyncIterator
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

from service.jobs.executor import Capacity, QueueFullError
from service.jobs.fair_queue import FairQueue
from service.jobs.work import PlanningWork, Told
from service.jobs.worker import main

GRACE_S = 2.0
"""Time above a request's own limit after which its worker is killed."""
LAST = ("finished", "failed", "canceled")


@dataclass(frozen=True)
class PoolParameters:
    """Sizes and limits of a pool."""

    workers: int = 2
    queue_limit: int = 100
    """Requests that wait at most."""
    memory_limit_mb: int = 4096
    """Address space of a worker, its libraries included [MiB]."""


@dataclass(eq=False)
class PooledRun:
    """A request in the pool."""

    work: PlanningWork
    pool: "ProcessPool"
    news: "asyncio.Queue[Told]" = field(default_factory=asyncio.Queue)
    canceled: asyncio.Event = field(default_factory=asyncio.Event)

    async def told(self) -> AsyncIterator[Told]:
        """What the worker tells, until the request ends."""
        while True:
            told = await self.news.get()
            yield told
            if told["kind"] in LAST:
                return

    def cancel(self) -> None:
        """Stops it at once and frees its worker."""
        if self.pool.forget(self):
            self.news.put_nowait({"kind": "canceled"})
        self.canceled.set()


class ProcessPool:
    """The `Executor` port on processes of this machine."""

    def __init__(self, parameters: PoolParameters) -> None:
        self._parameters = parameters
        self._queue: FairQueue[PooledRun] = FairQueue()
        self._waiting = asyncio.Semaphore(0)
        self._running = 0
        self._restarts = 0
        self._slots: list[asyncio.Task[None]] = []
        self._workers: set[Worker] = set()

    def submit(self, work: PlanningWork, *, client: str, priority: int) -> PooledRun:
        """Takes a request on.

        Raises:
            QueueFullError: the queue is full.
        """
        if len(self._queue) >= self._parameters.queue_limit:
            raise QueueFullError(f"{len(self._queue)} requests are waiting")
        run = PooledRun(work, self)
        self._queue.put(run, client=client, priority=priority)
        self._waiting.release()
        wanted = min(len(self._queue) + self._running, self._parameters.workers)
        if len(self._slots) < wanted:
            self._slots.append(asyncio.get_running_loop().create_task(self._slot()))
        return run

    def forget(self, run: PooledRun) -> bool:
        """Takes a request out of the queue; false if it is not waiting any more."""
        return self._queue.remove(run)

    def capacity(self) -> Capacity:
        """What is running and waiting now."""
        return Capacity(
            self._parameters.workers,
            self._running,
            len(self._queue),
            self._restarts,
            full=len(self._queue) >= self._parameters.queue_limit,
        )

    def workers(self) -> list["Worker"]:
        """The processes that are alive."""
        return list(self._workers)

    async def close(self) -> None:
        """Kills all workers."""
        for slot in self._slots:
            slot.cancel()
        await asyncio.gather(*self._slots, return_exceptions=True)

    async def _slot(self) -> None:
        """One worker after another, one request after another."""
        worker: Worker | None = None
        try:
            while True:
                await self._waiting.acquire()
                try:
                    run = self._queue.take()
                except IndexError:  # canceled while it waited
                    continue
                self._running += 1
                try:
                    if worker is None:
                        worker = Worker(self._parameters.memory_limit_mb)
                        self._workers.add(worker)
                    if not await self._serve(worker, run):
                        self._workers.discard(worker)
                        worker.kill()
                        worker = None
                        self._restarts += 1
                finally:
                    self._running -= 1
        finally:
            if worker is not None:
                worker.kill()

    async def _serve(self, worker: "Worker", run: PooledRun) -> bool:
        """Whether the worker is fit for another request."""
        if run.canceled.is_set():
            run.news.put_nowait({"kind": "canceled"})
            return True
        loop = asyncio.get_running_loop()
        deadline_s = loop.time() + run.work.time_limit_s + GRACE_S
        worker.send(run.work)
        canceled = loop.create_task(run.canceled.wait())
        heard = loop.create_task(worker.hear())
        try:
            while True:
                await asyncio.wait(
                    (heard, canceled),
                    timeout=max(deadline_s - loop.time(), 0.0),
                    return_when=asyncio.FIRST_COMPLETED,
                )
                if canceled.done() or not heard.done():
                    ending = {"kind": "canceled"} if canceled.done() else _overrun(run.work)
                    run.news.put_nowait(ending)
                    return False
                told = heard.result()
                run.news.put_nowait(told)
                if told["kind"] in LAST:
                    return told.get("outcome") != "crashed"
                heard = loop.create_task(worker.hear())
        finally:
            for task in (heard, canceled):
                task.cancel()
            await asyncio.gather(heard, canceled, return_exceptions=True)


def _overrun(work: PlanningWork) -> Told:
    return {
        "kind": "failed",
        "outcome": "timed_out",
        "message": f"stopped {GRACE_S:g} s after the time limit of {work.time_limit_s:g} s",
    }


class Worker:
    """A process and the pipe to it."""

    def __init__(self, memory_limit_mb: int) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe: Connection
        self._pipe, theirs = context.Pipe()
        self.process: BaseProcess = context.Process(
            target=main, args=(theirs, memory_limit_mb), name="planner", daemon=True
        )
        self.process.start()
        theirs.close()

    def send(self, work: PlanningWork) -> None:
        """Hands it a request; a dead worker is noticed on hearing."""
        with suppress(BrokenPipeError):
            self._pipe.send(work)

    async def hear(self) -> Told:
        """The next thing it tells; that it crashed, if it did."""
        loop = asyncio.get_running_loop()
        readable = asyncio.Event()
        loop.add_reader(self._pipe.fileno(), readable.set)
        try:
            if not self._pipe.poll():
                await readable.wait()
            told: Told = self._pipe.recv()
        except (EOFError, ConnectionResetError):
            self.process.join(1.0)
            code = self.process.exitcode
            return {
                "kind": "failed",
                "outcome": "crashed",
                "message": f"the planning process ended unexpectedly (exit code {code})",
            }
        finally:
            loop.remove_reader(self._pipe.fileno())
        return told

    def kill(self) -> None:
        """Ends the process at once."""
        self.process.kill()
        self.process.join(5.0)
        self._pipe.close()
