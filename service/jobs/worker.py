"""A worker process: takes work from a pipe, tells what it finds, until the pipe closes."""

import os
import resource
import select
import signal
import threading
from multiprocessing.connection import Connection
from pathlib import Path

from service.jobs.executor import Told
from service.jobs.parcels import Receiving
from service.tracing import continued

MIB = 2**20
NICENESS = 5
"""Planning takes what is left: a report is answered first on a machine that is busy."""
RELIEF_SHARE = 0.5
"""Above this share of its memory limit a worker drops what it keeps between works."""


def main(pipe: Connection, memory_limit_mb: int) -> None:
    """Serves one piece of work after the other.

    The address space is limited: work that wants more memory fails, or takes this process with it,
    but never the service. The process leads a group of its own, so that what it starts ends with
    it.
    """
    os.setpgrp()
    os.nice(NICENESS)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the service decides when to stop
    limit_memory(memory_limit_mb)
    threading.Thread(target=_end_with_the_service, args=(pipe,), daemon=True).start()
    receiving = Receiving()

    def tell(told: Told) -> None:
        pipe.send(told)

    while True:
        try:
            work, memory = receiving.unpack(pipe.recv_bytes())
        except EOFError:
            return
        with continued(work.traceparent):
            work.answer(tell, memory)
        if resident_mb() > memory_limit_mb * RELIEF_SHARE:
            receiving.relieve()


def limit_memory(limit_mb: int) -> None:
    """Limits the address space of this process [MiB]; no core dumps."""
    resource.setrlimit(resource.RLIMIT_AS, (limit_mb * MIB, limit_mb * MIB))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def resident_mb() -> float:
    """Memory of this process that is in RAM [MiB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / MIB


def mapped_mb() -> int:
    """Address space of this process [MiB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    return pages * os.sysconf("SC_PAGE_SIZE") // MIB


def _end_with_the_service(pipe: Connection) -> None:
    """A service that is killed leaves no process behind that goes on planning for nobody."""
    hung_up = select.poll()
    hung_up.register(pipe.fileno(), select.POLLHUP)
    while not hung_up.poll():
        pass
    os.killpg(0, signal.SIGKILL)
