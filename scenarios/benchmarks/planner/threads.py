"""One thread and two, each with the same CPU time: first plans and the best ones.

On an idle machine of two cores that is the same wall time; on a busy one wall times say little.
"""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from planner import Problem, read_domain, read_problem
from planner.solving import Limits, improving_plans
from scenarios.benchmarks._markdown import table
from scenarios.benchmarks.planner.instances import families, ipc_instances

OWN = ("d06-3x2-t10-b10", "d07-3x2-t15-b18", "m04-3c6r-t12")
IPC = (
    "2008 elevator 10",
    "2008 sokoban 10",
    "2011 storage 1",
    "2011 openstacks 10",
    "2011 parking 10",
    "2011 floor-tile 10",
    "2011 turn-and-open 5",
    "2011 temporal-machine-shop 10",
)

WALL_FACTOR = 20.0
"""Wall seconds allowed for a CPU second: the machine may be busy."""


@dataclass(frozen=True, slots=True)
class Solved:
    """What one search reached, times by thread; infinite without a plan."""

    first_s: float
    first: float
    best: float
    cpu_s: float


def run(data: Path, *, quick: bool) -> str:
    """One row an instance, means over the seeds."""
    limit_s = 2.0 if quick else 5.0
    seeds = (1,) if quick else (1, 2, 3)
    files = {one.name: one for one in families(data / "instances") + ipc_instances(data / "ipc")}
    rows = []
    for name in (*OWN, *IPC):
        if name not in files:
            continue
        problem = read_problem(read_domain(files[name].domain), files[name].problem)
        cells = [name]
        for threads in (1, 2):
            cells += _cells([solved(problem, threads, seed, limit_s) for seed in seeds])
        rows.append(cells)
    if not rows:
        return ""
    columns = ["instance"]
    for title in ("one thread", "two"):
        columns += [f"{title}: plans", "first after [s]", "best", "CPU s"]
    title = f"One thread and two, {limit_s:g} CPU seconds each, load {os.getloadavg()[0]:.1f}"
    return table(title, columns, rows)


def _cells(runs: Sequence[Solved]) -> list[str]:
    found = [run for run in runs if run.best < float("inf")]
    if not found:
        return [f"0 of {len(runs)}", "-", "-", _mean([run.cpu_s for run in runs], 1)]
    return [
        f"{len(found)} of {len(runs)}",
        _mean([run.first_s for run in found], 3),
        _mean([run.best for run in found], 1),
        _mean([run.cpu_s for run in runs], 1),
    ]


def _mean(values: Sequence[float], digits: int) -> str:
    return f"{sum(values) / len(values):.{digits}f}"


def solved(problem: Problem, threads: int, seed: int, limit_s: float) -> Solved:
    """One search."""
    begun_s = time.process_time()
    limits = Limits(
        timeout_s=WALL_FACTOR * limit_s,
        seed=seed,
        threads=threads,
        cpu_timeout_s=begun_s + threads * limit_s,
    )
    plans = list(improving_plans(problem, None, limits))
    values = [plan.makespan if plan.metric is None else plan.metric for plan in plans]
    first_s = plans[0].cpu_s if plans else None
    return Solved(
        (first_s - begun_s) / threads if first_s is not None else float("inf"),
        values[0] if values else float("inf"),
        values[-1] if values else float("inf"),
        (time.process_time() - begun_s) / threads,
    )
