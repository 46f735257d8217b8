"""A run in a process of its own, which may crash, hang or swell without harm to the others.

Processes are forked from a server that has imported everything already and has no threads: a run
does not pay for the imports, which would take a third of its time.
"""

from __future__ import annotations

import os
import resource
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

from scenarios.batch.suite import RunSpec, Suite

Row = dict[str, Any]
_running: set[BaseProcess] = set()


def stop_runs() -> None:
    """Kills all runs that this process has started; each ends as one that crashed."""
    for process in tuple(_running):
        process.kill()


def run_in_process(suite: Suite, spec: RunSpec) -> Row:
    """The row of a run; one that crashed or took too long says so in `status`."""
    planning = suite.planning.model_dump(exclude_unset=True) if suite.planning else None
    context = get_context("forkserver")
    context.set_forkserver_preload(["scenarios.batch.one_run"])
    answers, answer = context.Pipe(duplex=False)
    process = context.Process(
        target=_child, args=(answer, asdict(spec), planning, suite.limits.memory_mb), daemon=True
    )
    with _one_thread_each():
        process.start()
    _running.add(process)
    answer.close()
    deadline_s = time.monotonic() + suite.limits.wall_s
    try:
        if not answers.poll(max(0.0, deadline_s - time.monotonic())):
            return {"status": "killed", "reason": f"longer than {suite.limits.wall_s:g} s"}
        row: Row = answers.recv()
    except EOFError:
        process.join()
        return {"status": "crashed", "reason": f"exit code {process.exitcode}"}
    finally:
        process.kill()
        process.join()
        _running.discard(process)
        answers.close()
    return row


def _child(answer: Connection, spec: Row, planning: Row | None, memory_mb: int) -> None:
    """Runs the mission and sends its row."""
    from scenarios.batch.one_run import row_of_run

    limit = memory_mb * 2**20
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    try:
        row = row_of_run(RunSpec(**spec), planning)
    except BaseException as error:
        # Whatever it is, it costs one row and is told in it.
        lines = traceback.format_exception_only(error)
        row = {"status": "crashed", "reason": lines[-1].strip()[:300]}
    answer.send(row)
    answer.close()


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Numerical libraries of the processes started meanwhile use one thread."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")
    before = {name: os.environ.get(name) for name in names}
    os.environ.update(dict.fromkeys(names, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
