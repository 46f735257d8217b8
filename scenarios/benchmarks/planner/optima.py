"""Over five seeds: whether the known optima are reached in time, and which are proved."""

from __future__ import annotations

from pathlib import Path

from scenarios.benchmarks._markdown import table
from scenarios.benchmarks.planner.contest import Run, run_own
from scenarios.benchmarks.planner.instances import OPTIMA_S, families

SEEDS = (1, 2, 3, 4, 5)
SLOW = {"m04-3c6r-t12": 10.0}
"""CPU seconds for those that may take longer than one."""
EPSILONS_S = 0.1
"""Steps that follow each other are kept apart: so much more is the same makespan."""


def run(folder: Path, *, quick: bool) -> str:
    """One row an instance; empty where the instances are absent."""
    seeds = SEEDS[:1] if quick else SEEDS
    rows = []
    for instance in families(folder):
        limit_s = SLOW.get(instance.name, 1.0)
        runs = [run_own(instance, limit_s, seed) for seed in seeds]
        rows.append([instance.name, f"{OPTIMA_S[instance.name]:g}", f"{limit_s:g}", *cells(runs)])
    if not rows:
        return ""
    columns = [
        "instance",
        "optimum",
        "CPU s",
        "makespans by seed",
        "all optimal",
        "reached after [s]",
        "first plan after [s]",
        "proved",
        "MB",
    ]
    return table(f"Known optima over {len(seeds)} seeds", columns, rows)


def cells(runs: list[Run]) -> list[str]:
    """What the runs on one instance reached; times are the worst over the seeds."""
    optimum = OPTIMA_S[runs[0].instance]
    values = [run.best for run in runs]
    reached = [
        next((at_s for at_s, value in run.plans if value <= optimum + EPSILONS_S), None)
        for run in runs
    ]
    first_s = [run.plans[0][0] for run in runs if run.plans]
    proved = sum(run.outcome == "solved_optimally" for run in runs)
    times_s = [at_s for at_s in reached if at_s is not None]
    return [
        ", ".join("-" if value is None else f"{value:.0f}" for value in values),
        "yes" if len(times_s) == len(runs) else "no",
        f"{max(times_s):.3f}" if times_s else "-",
        f"{max(at_s or 0.0 for at_s in first_s):.3f}" if first_s else "-",
        f"{proved} of {len(runs)}",
        f"{max(run.peak_mb for run in runs):.0f}",
    ]
