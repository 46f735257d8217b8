"""Workers that are Ray actors: on this machine, or on every machine of a Ray cluster.

Ray places and replaces processes; queue, fairness, limits and warm workers are the pool's, as on
one machine. Needs the extra `marsupial[cluster]`.
"""

import asyncio
import logging
import os
import queue
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

import ray
from ray.exceptions import RayError

from service.jobs.executor import LAST, Told
from service.jobs.parcels import Receiving
from service.jobs.worker import RELIEF_SHARE, limit_memory, mapped_mb, resident_mb
from service.jobs.worker_pool import PoolParameters, WorkerPool
from service.tracing import continued

LOG = logging.getLogger(__name__)
OBJECT_STORE_BYTES = 80 * 2**20
"""Of a Ray that is started here: parcels and plans are small."""


def ray_pool(
    parameters: PoolParameters,
    address: str | None,
    waited: Callable[[float], None] = lambda _: None,
) -> WorkerPool:
    """A pool of Ray actors.

    Args:
        address: of the Ray cluster to join; None starts Ray on this machine.
    """

    async def hire() -> RayWorker:
        await asyncio.to_thread(join, address, parameters.workers)
        return await RayWorker.hired(parameters.memory_limit_mb)

    return WorkerPool(parameters, hire, waited)


_JOINING = threading.Lock()


def join(address: str | None, workers: int) -> None:
    """Connects to Ray, once a process; starts one for this machine where there is no address."""
    with _JOINING:
        if ray.is_initialized():
            return
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
        quiet: dict[str, Any] = {"log_to_driver": False, "logging_level": logging.ERROR}
        if address is not None:
            ray.init(address=address, **quiet)
            return
        ray.init(
            # Two pools of workers; they are processes that wait more than they work.
            num_cpus=max(2 * workers, os.cpu_count() or 1),
            include_dashboard=False,
            object_store_memory=OBJECT_STORE_BYTES,
            # A checkout that is not installed is importable here, so it has to be there.
            runtime_env={"env_vars": {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}},
            **quiet,
        )


def leave() -> None:
    """Lets go of Ray; one that was started here ends."""
    with _JOINING:
        ray.shutdown()


class PlanningActor:
    """The worker's side: one piece of work at a time."""

    def __init__(self, memory_limit_mb: int) -> None:
        # What Ray itself has mapped, its object store above all, does not count.
        limit_memory(memory_limit_mb + mapped_mb())
        self._relief_mb = memory_limit_mb * RELIEF_SHARE
        self._receiving = Receiving()

    def answer(self, parcel: bytes) -> Iterator[Told]:
        """Everything that the work tells, as soon as it is told and lets other threads run."""
        work, memory = self._receiving.unpack(parcel)
        news: queue.SimpleQueue[Told] = queue.SimpleQueue()

        def compute() -> None:
            try:
                with continued(work.traceparent):
                    work.answer(news.put, memory)
            except BaseException as error:
                news.put({"kind": "failed", "outcome": "crashed", "message": repr(error)})

        threading.Thread(target=compute, daemon=True).start()
        while True:
            told = news.get()
            yield told
            if told["kind"] in LAST:
                break
        if resident_mb() > self._relief_mb:
            self._receiving.relieve()

    def pid(self) -> int:
        """Its process id."""
        return os.getpid()


class RayWorker:
    """An actor and what it tells."""

    def __init__(self, actor: Any, pid: int) -> None:
        self.pid = pid
        self._actor = actor
        self._news: asyncio.Queue[Told] = asyncio.Queue()
        self._listening: asyncio.Task[None] | None = None

    @classmethod
    async def hired(cls, memory_limit_mb: int) -> "RayWorker":
        """A new actor, once its process is there."""
        remote: Any = ray.remote(num_cpus=1, max_restarts=0)(PlanningActor)
        actor = remote.remote(memory_limit_mb)
        try:
            return cls(actor, await actor.pid.remote())
        except asyncio.CancelledError:
            ray.kill(actor, no_restart=True)
            raise

    async def send(self, parcel: bytes) -> None:
        """Hands it work; a dead worker is noticed on hearing."""
        told = self._actor.answer.options(num_returns="streaming").remote(parcel)
        self._listening = asyncio.get_running_loop().create_task(self._listen(told))

    async def _listen(self, references: Any) -> None:
        try:
            async for reference in references:
                self._news.put_nowait(await reference)
        except RayError as error:
            reason = str(error).strip().splitlines()[-1].split(". ")[0]
            self._news.put_nowait(
                {
                    "kind": "failed",
                    "outcome": "crashed",
                    "message": f"the planning process ended unexpectedly ({reason})",
                }
            )

    async def hear(self) -> Told:
        """The next thing it tells; that it crashed, if it did."""
        return await self._news.get()

    def kill(self) -> None:
        """Ends the process at once."""
        if self._listening is not None:
            self._listening.cancel()
        ray.kill(self._actor, no_restart=True)
