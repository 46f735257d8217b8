"""A worker process: takes requests from a pipe, tells what it finds, until the pipe closes."""

import resource
import signal
from multiprocessing.connection import Connection

from service.jobs.work import PlanningWork, Told, answer

MIB = 2**20


def main(pipe: Connection, memory_limit_mb: int) -> None:
    """Serves one request after the other.

    The address space is limited: a request that wants more memory fails, or takes this process
    with it, but never the service.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the service decides when to stop
    resource.setrlimit(resource.RLIMIT_AS, (memory_limit_mb * MIB, memory_limit_mb * MIB))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    while True:
        try:
            work: PlanningWork = pipe.recv()
        except EOFError:
            return

        def tell(told: Told) -> None:
            pipe.send(told)

        answer(work, tell)
