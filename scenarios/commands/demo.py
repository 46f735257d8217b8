"""`marsupial demo`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def demo(
    seed: Annotated[int, typer.Option(help="Draws the start poses of the fleet.")] = 1,
    out: Annotated[Path, typer.Option(help="Folder for the report.")] = Path("out"),
) -> None:
    """Run the hospital mission: two explorers, two clearers, 15 targets, 18 hidden blockades.

    Prints the path of a report with the map, the driven paths and the Gantt chart.
    """
    from importlib.resources import as_file, files

    from scenarios.mission import RunOptions, run_and_report

    with as_file(files("scenarios")) as room:
        options = RunOptions(seed=seed, strategy="planner", out=out)
        run_and_report(room / "disaster" / "hospital.toml", options)
