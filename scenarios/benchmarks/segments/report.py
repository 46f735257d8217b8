"""Runs the experiments and writes tables, figures and pictures."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from scenarios.batch.comparison import compare
from scenarios.benchmarks.segments.doorways import doorway_table
from scenarios.benchmarks.segments.experiments import (
    BASELINE,
    LARGE_TEAMS,
    RADIO,
    REAL_BUILDINGS,
    experiments,
)
from scenarios.benchmarks.segments.figures import improvement_figure
from scenarios.benchmarks.segments.pictures import draw_pictures
from scenarios.benchmarks.segments.speed import speed_table
from scenarios.benchmarks.segments.tables import comparison_table, radio_table, team_size_table
from scenarios.benchmarks.segments.two_robots import two_robot_table
from scenarios.exploration.buildings import generated
from scenarios.exploration.experiments import Row, run_all

DRAWN = ("large_rooms", "small_rooms")
LEAST_PAIRS_DRAWN = 3
"""The interval of two pairs would set the scale of a figure and say nothing."""
PICTURES = (("small_rooms", 45.0), ("large_rooms", 120.0))
"""buildings and the times of the decisions that are drawn [s]"""


def run(*, quick: bool, out: Path) -> str:
    """Runs what is missing from `out/runs.csv` and returns the report in Markdown."""
    chosen = experiments(quick=quick)
    rows = run_all(chosen, out / "runs.csv", _progress)
    return report(rows, quick=quick, out=out)


def report(rows: Sequence[Row], *, quick: bool, out: Path) -> str:
    """The report on runs, in Markdown; measures doorways and speed, and draws pictures."""
    of = {name: [row for row in rows if row["map"] == name] for name in {r["map"] for r in rows}}
    parts = ["# Exploration by segments of the map", ""]
    for name in DRAWN:
        parts += _experiment(name, of.get(name, []), out)
    parts += ["## Teams of every size", ""]
    for name in DRAWN:
        together = of.get(name, []) + of.get(f"{name}, {LARGE_TEAMS}", [])
        arms = (BASELINE, "segments by hand", "segments")
        shown = [arm for arm in arms if any(row["strategy"] == arm for row in together)]
        parts += [f"{name}:", "", *team_size_table(together, shown, BASELINE), ""]
    for name in DRAWN:
        parts += _experiment(f"{name}, {LARGE_TEAMS}", of.get(f"{name}, {LARGE_TEAMS}", []), out)
    for name in DRAWN:
        short = of.get(f"{name}, {RADIO}", [])
        parts += _experiment(f"{name}, {RADIO}", short, out)
        if short:
            parts += [
                "Beside unlimited radio:",
                "",
                *radio_table(short, of.get(name, [])),
                "",
            ]
    parts += ["## Real buildings", ""]
    for name in REAL_BUILDINGS:
        if name in of:
            parts += _experiment(name, of[name], out, level=3)
        elif not quick:
            parts += [f"The map of {name} is not in ../shared/data: left out.", ""]
    if quick:
        parts += ["Left out of the quick form.", ""]
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


def _experiment(name: str, rows: list[Row], out: Path, level: int = 2) -> list[str]:
    """One experiment's table and figure; nothing without pairs."""
    arms = [arm for arm in dict.fromkeys(row["strategy"] for row in rows) if arm != BASELINE]
    comparisons = [c for arm in arms for c in compare(rows, arm, BASELINE)]
    if not comparisons:
        return []
    comparisons.sort(key=lambda c: (int(c.team.split()[0]), arms.index(c.strategy)))
    failed = sum(row["status"] != "completed" for row in rows)
    parts = [f"{'#' * level} {name}", "", *comparison_table(comparisons, rows), ""]
    if failed:
        parts += [f"{failed} of {len(rows)} runs did not complete and are left out.", ""]
    drawn = [c for c in comparisons if c.pairs >= LEAST_PAIRS_DRAWN]
    if not drawn:
        return parts
    file = f"{name.replace(', ', '_').replace(' ', '_')}.svg"
    (out / file).write_text(
        improvement_figure(f"{name}: time saved against nearest frontier", drawn),
        encoding="utf-8",
    )
    return [*parts, f"![time saved]({file})", ""]


def _progress(done: int, total: int) -> None:
    width = shutil.get_terminal_size().columns
    print(f"{done} of {total} runs".ljust(width - 1), end="\r", flush=True)
