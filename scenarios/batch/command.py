"""Runs a suite for the command line: progress with the time left, then the report."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from scenarios.batch.execution import execute, rows
from scenarios.batch.findings import findings
from scenarios.batch.ray_runs import on_ray
from scenarios.batch.results import markdown, write
from scenarios.batch.run_process import run_in_process
from scenarios.batch.suite import Suite, read_suite
from scenarios.exit_codes import CommandError
from scenarios.report.markup import clock
from scenarios.scenario_file import ScenarioFileError, read_scenario
from service.coordination.strategies import all_strategies

LINE_EVERY_S = 30.0
"""wall time between two plain lines"""


def run_suite(
    path: Path, folder: Path, *, quick: bool, jobs: int, resume: bool, executor: str = "process"
) -> None:
    """Runs what is missing of a suite and writes its report.

    Raises:
        CommandError: the suite cannot be read, or there are results and `resume` is not given.
    """
    try:
        suite = read_suite(path)
    except ScenarioFileError as error:
        raise CommandError(str(error)) from None
    _refuse_unknown_strategies(path, suite)
    _refuse_unknown_robot_types(path, suite)
    if quick:
        suite = suite.quickly()
    perform = on_ray(jobs) if executor == "ray" else run_in_process
    begin_s, first = time.monotonic(), -1
    told_s = begin_s - LINE_EVERY_S
    try:
        with _terminated_like_interrupted():
            for done, wanted in execute(suite, folder, jobs=jobs, resume=resume, perform=perform):
                now_s = time.monotonic()
                first = done if first < 0 else first
                if now_s - told_s >= LINE_EVERY_S or done == wanted:
                    told_s = now_s
                    left = _left(done, wanted, first, begin_s)
                    _say(f"{suite.name}: {done} of {wanted} runs{left}")
    except FileExistsError as error:
        raise CommandError(str(error)) from None
    except KeyboardInterrupt:
        options = f"{'--quick ' if quick else ''}--jobs {jobs} --executor {executor}"
        options += f" --out {folder.parent} --resume"
        _say(f"stopped; go on with `marsupial bench {path} {options}`")
        raise
    found = findings(suite, rows(folder))
    report = write(found, folder)
    print(markdown(found))
    print(f"report: {report.resolve()}")


@contextmanager
def _terminated_like_interrupted() -> Iterator[None]:
    """SIGTERM stops the runs as Ctrl-C does, where signals are this thread's to handle."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(_signal: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _refuse_unknown_strategies(path: Path, suite: Suite) -> None:
    """Before hours of runs, each of which would say so."""
    known = all_strategies()
    for name in suite.all_strategies:
        coordination = suite.variants[name].strategy if name in suite.variants else name
        if coordination not in known:
            there = ", ".join(sorted(known))
            raise CommandError(f"{path}: no strategy {coordination!r}: there are {there}")


def _refuse_unknown_robot_types(path: Path, suite: Suite) -> None:
    for entry in suite.maps:
        try:
            known = read_scenario(entry.scenario).robot_types
        except ScenarioFileError as error:
            raise CommandError(str(error)) from None
        named = [entry.teams or suite.teams, *(arm.teams or () for arm in entry.arms)]
        for kind in sorted({kind for teams in named for team in teams for kind in team}):
            if kind not in known:
                raise CommandError(
                    f"{path}: maps.{entry.name}: a team has the robot type {kind!r}, which "
                    f"{entry.scenario.name} does not define: it has {', '.join(sorted(known))}"
                )


def _left(done: int, wanted: int, first: int, begin_s: float) -> str:
    """How long the rest takes at the pace so far."""
    if done in (first, wanted):
        return ""
    pace_s = (time.monotonic() - begin_s) / (done - first)
    return f", {clock(pace_s * (wanted - done))} left (min:s)"


def _say(message: str) -> None:
    sys.stderr.write(message + "\n")
    sys.stderr.flush()
