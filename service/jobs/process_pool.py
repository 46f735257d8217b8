"""Workers that are processes of this machine, with hard limits on time and memory.

They are forked from a process that has loaded the planner and nothing else: a new worker is there
within milliseconds and shares its libraries' memory with the others.
"""

import asyncio
import multiprocessing
import os
import signal
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext
from multiprocessing.process import BaseProcess

from service.jobs.executor import Told
from service.jobs.worker import main
from service.jobs.worker_pool import PoolParameters, WorkerPool

PRELOADED = ["service.jobs.worker", "service.jobs.work", "service.coordination.strategies"]
AT_ONCE = 32 * 1024
"""Bytes that a pipe takes without waiting for its reader."""


def process_pool(
    parameters: PoolParameters, waited: Callable[[float], None] = lambda _: None
) -> WorkerPool:
    """A pool of processes of this machine."""

    async def hire() -> ProcessWorker:
        # Starting the server that workers are forked from takes a second.
        return await asyncio.to_thread(ProcessWorker, parameters.memory_limit_mb)

    return WorkerPool(parameters, hire, waited)


class ProcessWorker:
    """A process and the pipe to it."""

    def __init__(self, memory_limit_mb: int) -> None:
        context: ForkServerContext = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(PRELOADED)
        self._pipe: Connection
        self._pipe, theirs = context.Pipe()
        self.process: BaseProcess = context.Process(
            target=main, args=(theirs, memory_limit_mb), name="planner", daemon=True
        )
        self.process.start()
        theirs.close()

    async def send(self, parcel: bytes) -> None:
        """Hands it work; a dead worker is noticed on hearing."""
        with suppress(BrokenPipeError, ConnectionResetError):
            if len(parcel) <= AT_ONCE:
                self._pipe.send_bytes(parcel)
            else:
                await asyncio.to_thread(self._pipe.send_bytes, parcel)

    async def hear(self) -> Told:
        """The next thing it tells; that it crashed, if it did."""
        loop = asyncio.get_running_loop()
        readable = asyncio.Event()
        loop.add_reader(self._pipe.fileno(), readable.set)
        try:
            if not self._pipe.poll():
                await readable.wait()
            told: Told = self._pipe.recv()
        except (EOFError, OSError):
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
        """Ends the process at once, and those that it has started."""
        if self.process.pid is not None:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self.process.pid, signal.SIGKILL)
        self.process.kill()
        self.process.join(5.0)
        self._pipe.close()
