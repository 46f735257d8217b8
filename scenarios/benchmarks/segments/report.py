"""Runs the experiments and writes tables, figures and pictures."""

from __future__ import annotations

import shutil
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from scenarios.batch.comparison import Comparison, compare
from scenarios.benchmarks.segments.doorways import doorway_table
from scenarios.benchmarks.segments.experiments import experiments
from scenarios.benchmarks.segments.figures import improvement_figure
from scenarios.benchmarks.segments.pictures import draw_pictures
from scenarios.benchmarks.segments.speed import speed_table
from scenarios.benchmarks.segments.two_robots import two_robot_table
from scenarios.exploration.buildings import generated
from scenarios.exploration.experiments import Row, run_all

PICTURES = (("small_rooms", 45.0), ("large_rooms", 120.0))
"""buildings and the times of the decisions that are drawn [s]"""


def run(*, quick: bool, out: Path) -> str:
    """Runs what is missing from `out/runs.csv` and returns the report in Markdown."""
    rows = run_all(experiments(quick=quick), out / "runs.csv", _progress)
    parts = ["# Exploration by segments of the map", ""]
    for name, of_map in _by_map(rows).items():
        parts += _experiment(name, of_map, out)
    parts += ["## Two robots (section 2.6.2)", "", two_robot_table(quick=quick), ""]
    parts += ["## Doorways", "", doorway_table(quick=quick), ""]
    parts += ["## Speed", "", speed_table(quick=quick), ""]
    parts += ["## Pictures", ""]
    for name, time_s in PICTURES[:1] if quick else PICTURES:
        for path in draw_pictures(generated(name, 1), 4, time_s, out):
            parts.append(f"![{path.stem.replace('_', ' ')}]({path.name})")
    command = "marsupial bench segments" + (" --quick" if quick else "")
    parts += ["", f"Reproduced by `{command}`; finished runs are kept in `runs.csv`.", ""]
    return "\n".join(parts)


def _by_map(rows: Sequence[Row]) -> dict[str, list[Row]]:
    found: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        found[row["map"]].append(row)
    return found


def _experiment(name: str, rows: list[Row], out: Path) -> list[str]:
    """One experiment's table, and its figure if there are several teams."""
    arms = [arm for arm in dict.fromkeys(row["strategy"] for row in rows) if arm != "nearest"]
    comparisons = [c for arm in arms for c in compare(rows, arm, "nearest")]
    if not comparisons:
        return []
    comparisons.sort(key=lambda c: (int(c.team.split()[0]), arms.index(c.strategy)))
    failed = sum(row["status"] != "completed" for row in rows)
    parts = [f"## {name}", "", *_table(comparisons, rows), ""]
    if failed:
        parts += [f"{failed} of {len(rows)} runs did not complete and are left out.", ""]
    file = f"{name.replace(', ', '_').replace(' ', '_')}.svg"
    (out / file).write_text(
        improvement_figure(f"{name}: time saved against nearest frontier", comparisons),
        encoding="utf-8",
    )
    return [*parts, f"![time saved]({file})", ""]


def _table(comparisons: Sequence[Comparison], rows: Sequence[Row]) -> list[str]:
    lines = [
        "| team | strategy | pairs | nearest [s] | its time [s] | saved | p (t) | p (Holm) | wins "
        "| driven |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for c in comparisons:
        share = c.gain
        driven = np.mean(
            [r["driven_m"] for r in rows if r["team"] == c.team and r["strategy"] == c.strategy]
        )
        lines.append(
            f"| {c.team} | {c.strategy} | {c.pairs} | {c.reference_value.mean:.0f} "
            f"| {c.value.mean:.0f} | {100 * share.mean:+.1f} % "
            f"({100 * share.low:+.1f} to {100 * share.high:+.1f}) | {c.t_test_p:.2g} "
            f"| {c.holm_p:.2g}{' *' if c.significant else ''} | {c.wins} : {c.losses} "
            f"| {driven:.0f} m |"
        )
    return lines


def _progress(done: int, total: int) -> None:
    width = shutil.get_terminal_size().columns
    print(f"{done} of {total} runs".ljust(width - 1), end="\r", flush=True)
