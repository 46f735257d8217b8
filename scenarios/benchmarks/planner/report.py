"""Tables of runs, with the losses shown."""

from __future__ import annotations

from collections.abc import Sequence

from scenarios.benchmarks._markdown import table
from scenarios.benchmarks.planner.contest import Run
from scenarios.benchmarks.planner.engines import OWN
from scenarios.benchmarks.planner.instances import OPTIMA_S

TIE = 1e-3
"""Values closer than this part are the same: engines keep steps apart by different epsilons."""


def markdown(runs: Sequence[Run], engines: Sequence[str], limit_s: float) -> str:
    """All tables."""
    ipc = [run for run in runs if run.family[0].isdigit()]
    own = [run for run in runs if not run.family[0].isdigit()]
    parts = []
    if own:
        parts.append(instances_table(own, engines, limit_s))
    if ipc:
        parts.append(domains_table(ipc, engines, limit_s))
        parts.append(losses(ipc) if engines[1:] else "No peer is installed.")
    return "\n\n".join(parts)


def instances_table(runs: Sequence[Run], engines: Sequence[str], limit_s: float) -> str:
    """One row an instance: first plan, best at 1 s, best, bound; the peers' best."""
    rows = []
    for name in dict.fromkeys(run.instance for run in runs):
        by_engine = {run.engine: run for run in runs if run.instance == name}
        own = by_engine[OWN]
        peers = [_shown(by_engine.get(engine)) for engine in engines[1:]]
        first_s = f"{own.plans[0][0] or 0.0:.3f}" if own.plans else "-"
        optimum = f"{OPTIMA_S[name]:g}" if name in OPTIMA_S else "-"
        row = [name, optimum, first_s, _best_at(own, 1.0), _shown(own)]
        rows.append([*row, own.outcome, f"{own.peak_mb:.0f}", *peers])
    columns = ["instance", "optimum", "first plan [s]", "best at 1 s", "best", "outcome", "MB"]
    title = f"Disaster and marsupial instances, {limit_s:g} CPU seconds"
    return table(title, [*columns, *engines[1:]], rows)


def domains_table(runs: Sequence[Run], engines: Sequence[str], limit_s: float) -> str:
    """One row an IPC domain: instances, solved and sat score of each engine."""
    scores = sat_scores(runs)
    rows = []
    for family in [*dict.fromkeys(run.family for run in runs), "all"]:
        here = [run for run in runs if family in ("all", run.family)]
        row: list[object] = [family, len({run.instance for run in here})]
        for engine in engines:
            mine = [run for run in here if run.engine == engine]
            solved = sum(run.best is not None for run in mine)
            score = sum(scores[run.instance, engine] for run in mine)
            row += [f"{solved} / {score:.2f}"]
        rows.append(row)
    title = f"IPC temporal satisficing, {limit_s:g} CPU seconds: solved / sat score"
    return table(title, ["domain", "instances", *engines], rows)


def sat_scores(runs: Sequence[Run]) -> dict[tuple[str, str], float]:
    """Best value of this run over the engine's own; 0 without a plan (minimisation)."""
    best: dict[str, float] = {}
    for run in runs:
        if run.best is not None:
            best[run.instance] = min(run.best, best.get(run.instance, float("inf")))
    return {
        (run.instance, run.engine): 0.0 if run.best is None else _part(best[run.instance], run.best)
        for run in runs
    }


def _part(best: float, own: float) -> float:
    return best / own if own > 0 and best < own * (1 - TIE) else 1.0


def losses(runs: Sequence[Run]) -> str:
    """Instances on which a peer is better, worst first."""
    scores = sat_scores(runs)
    rows = []
    for run in runs:
        score = scores[run.instance, run.engine]
        others = [
            other for other in runs if other.instance == run.instance and other.best is not None
        ]
        if run.engine != OWN or score >= 1.0 or not others:
            continue
        winner = min(others, key=lambda other: other.best or 0.0)
        cells = [run.instance, _shown(run), run.outcome, winner.engine, _shown(winner)]
        rows.append((score, cells))
    if not rows:
        return "No peer is better anywhere."
    rows.sort(key=lambda row: row[0])
    columns = ["instance", "marsupial", "outcome", "best peer", "its plan"]
    return table("Losses", columns, [cells for _, cells in rows])


def _best_at(run: Run, when_s: float) -> str:
    values = [value for at_s, value in run.plans if at_s is not None and at_s <= when_s]
    return f"{values[-1]:.2f}" if values else "-"


def _shown(run: Run | None) -> str:
    return "-" if run is None or run.best is None else f"{run.best:.2f}"
