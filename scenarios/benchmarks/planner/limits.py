"""How well limits hold: wall and CPU time, nodes, memory; how soon a search stops when asked.

Every problem is planned in a process of its own. Time counts from reading the files on. Moments of
cancelling are spread from the first milliseconds on, so that they fall into grounding, the
preparations and every kind of search.
"""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from planner import Problem, read_domain, read_problem, solve
from planner.attachments import Attachments
from planner.outcome import Outcome
from planner.solving import Limits, Result, improving_plans, started
from scenarios.benchmarks._markdown import table
from scenarios.benchmarks.planner import large_team, rates
from scenarios.benchmarks.planner.instances import families, ipc_instances

IPC = (
    "2011 openstacks 20",
    "2011 parking 19",
    "2011 storage 20",
    "2008 sokoban 24",
    "2008 transport-numeric-fluents 20",
    "2008 elevator 30",
)
"""Much to ground, long lists, deep searches."""
OWN = ("d06-3x2-t10-b10", "m03-2c4r-t8")
NODES = (300, 3_000)
MEMORY_MB = 96
MEMORY_WAIT_S = 20.0
NODE_WAIT_S = 10.0
NODE_OUTCOMES = (Outcome.SOLVED_OUT_OF_MEMORY, Outcome.OUT_OF_NODES)
"""A search that has a plan says the same of nodes and memory."""


@dataclass(frozen=True, slots=True)
class Case:
    """A problem by name, with its files if it has any."""

    name: str
    domain: Path | None = None
    problem: Path | None = None

    def read(self) -> tuple[Problem, Attachments]:
        """The problem and what computes its modules."""
        if self.domain is not None and self.problem is not None:
            return read_problem(read_domain(self.domain), self.problem), {}
        if self.name == "hospital, cost modules":
            return rates.generated(rates.SIZES[0], seed=1)
        return large_team.Field(60, 40, 300, 100, seed=1).read()


@dataclass(frozen=True, slots=True)
class Measured:
    """Worst cases; None where no search came to the limit."""

    wall_over_ms: float | None
    cpu_over_ms: float | None
    stops_after_ms: float | None
    stops_after_cpu_ms: float | None
    nodes_over: int | None
    memory_over_mb: float | None


def run(data: Path, *, quick: bool) -> str:
    """The table, one row a problem."""
    cases = chosen(data)
    times_s = (0.2, 1.0) if quick else (0.1, 0.3, 1.0, 3.0)
    moments_s = (0.01, 0.3) if quick else (0.003, 0.02, 0.06, 0.15, 0.4, 1.0, 2.5)
    rows = []
    for case in cases[::4] if quick else cases:
        found = in_a_process(case, times_s, moments_s)
        values = (
            found.wall_over_ms,
            found.cpu_over_ms,
            found.stops_after_ms,
            found.stops_after_cpu_ms,
            found.nodes_over,
            found.memory_over_mb,
        )
        rows.append([case.name, *("-" if value is None else f"{value:.0f}" for value in values)])
    columns = [
        "problem",
        "wall time over [ms]",
        "CPU time over [ms]",
        "stops after [ms]",
        "CPU time till then [ms]",
        "nodes over",
        f"memory over {MEMORY_MB} [MiB]",
    ]
    shown = ", ".join(f"{limit_s:g}" for limit_s in times_s)
    return table(f"Limits: the worst of {shown} s, and of stopping", columns, rows)


def chosen(data: Path) -> list[Case]:
    """The problems; instances whose files are absent are left out."""
    files = families(data / "instances") + ipc_instances(data / "ipc")
    by_name = {one.name: one for one in files}
    cases = [
        Case(name, by_name[name].domain, by_name[name].problem)
        for name in (*OWN, *IPC)
        if name in by_name
    ]
    return [*cases, Case("hospital, cost modules"), Case("100 robots, cost modules")]


def in_a_process(case: Case, times_s: Sequence[float], moments_s: Sequence[float]) -> Measured:
    """Measures in a new process, whose memory and CPU time are its own."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(sender, case, times_s, moments_s))
    process.start()
    sender.close()
    try:
        measured: Measured = receiver.recv()
        return measured
    finally:
        process.join()


def _work(sender: Any, case: Case, times_s: Sequence[float], moments_s: Sequence[float]) -> None:
    sender.send(measure(case, times_s, moments_s))


def measure(case: Case, times_s: Sequence[float], moments_s: Sequence[float]) -> Measured:
    """All limits on one problem."""
    problem, attachments = case.read()
    memory = memory_over_mb(problem, attachments)
    stops = [stopping_ms(problem, attachments, moment_s) for moment_s in moments_s]
    return Measured(
        _worst([_over_ms(time.monotonic, case, limit_s) for limit_s in times_s]),
        _worst([_over_ms(time.process_time, case, limit_s) for limit_s in times_s]),
        _worst([stop[0] for stop in stops if stop is not None]),
        _worst([stop[1] for stop in stops if stop is not None]),
        _worst([nodes_over(problem, attachments, limit) for limit in NODES]),
        memory,
    )


def _worst(values: Sequence[float | None]) -> Any:
    """The largest."""
    return max((value for value in values if value is not None), default=None)


def _over_ms(clock: Callable[[], float], case: Case, limit_s: float) -> float | None:
    """By how much a time limit is missed [ms]; None if the search was done before."""
    begun_s = clock()
    if clock is time.process_time:
        problem, attachments = case.read()
        limits = Limits(timeout_s=None, cpu_timeout_s=begun_s + limit_s)
        result = _exhausted(improving_plans(problem, attachments, limits))
    elif case.domain is not None and case.problem is not None:
        result = solve(case.domain, case.problem, timeout_s=limit_s)
    else:
        problem, attachments = case.read()
        begun_s = clock()
        result = solve(problem.domain, problem, attachments=attachments, timeout_s=limit_s)
    over_ms = 1000 * (clock() - begun_s - limit_s)
    return over_ms if result.outcome.value.endswith("timed_out") else None


def _exhausted(search: Any) -> Result:
    while True:
        try:
            next(search)
        except StopIteration as end:
            result: Result = end.value
            return result


def stopping_ms(
    problem: Problem, attachments: Attachments, moment_s: float
) -> tuple[float, float] | None:
    """How long a search goes on when it is cancelled after a time: wall and CPU time [ms]."""
    search = started(problem, attachments, Limits(timeout_s=None))
    time.sleep(moment_s)
    begun_s, cpu_begun_s = time.monotonic(), time.process_time()
    search.cancel()
    while True:
        event = search.next(10.0)
        if event is None:
            return float("inf"), float("inf")
        if event.report is not None:
            took_s = time.monotonic() - begun_s, time.process_time() - cpu_begun_s
            stopped = event.report.limit == "cancelled"
            return (1000 * took_s[0], 1000 * took_s[1]) if stopped else None


def nodes_over(problem: Problem, attachments: Attachments, limit: int) -> float | None:
    """States and lists beyond the limit."""
    result = solve(
        problem.domain, problem, attachments=attachments, timeout_s=NODE_WAIT_S, node_limit=limit
    )
    spent = result.statistics.expansions + result.statistics.schedules
    return spent - limit if result.outcome in NODE_OUTCOMES else None


def memory_over_mb(problem: Problem, attachments: Attachments) -> float | None:
    """Growth of the process beyond the limit [MiB], grounding included."""
    Path("/proc/self/clear_refs").write_text("5")
    before_mb = _status_mb("VmRSS")
    solve(
        problem.domain,
        problem,
        attachments=attachments,
        timeout_s=MEMORY_WAIT_S,
        memory_limit_mb=MEMORY_MB,
    )
    return _status_mb("VmHWM") - before_mb - MEMORY_MB


def _status_mb(key: str) -> float:
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(f"{key}:"):
            return int(line.split()[1]) / 1024
    raise ValueError(key)
