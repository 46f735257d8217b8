"""`marsupial run`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def run(
    scenario: Annotated[Path, typer.Argument(help="Scenario file (TOML).", show_default=False)],
    *,
    seed: Annotated[int, typer.Option(help="Draws the start poses of the fleet.")] = 1,
    strategy: Annotated[
        str | None,
        typer.Option(help="planner, hungarian, auction, ...; the scenario file's if not given."),
    ] = None,
    headless: Annotated[
        bool, typer.Option("--headless", help="No progress display and no report.")
    ] = False,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write everything that happened to this file.")
    ] = None,
    report: Annotated[
        Path | None, typer.Option(help="Write the HTML report to this file.", show_default="out/")
    ] = None,
    movie: Annotated[
        Path | None,
        typer.Option(help="Write a film of the mission to this file, .gif or .mp4 (by ffmpeg)."),
    ] = None,
    service: Annotated[
        str | None,
        typer.Option(help="Address of a running service; by default one runs inside."),
    ] = None,
    key: Annotated[
        str | None,
        typer.Option(envvar="MARSUPIAL_KEY", help="API key for that service."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for reports.")] = Path("out"),
) -> None:
    """Run a scenario: a simulated fleet reports to the service and carries out its commands.

    Ends with 0 when every target was visited, 12 when the team cannot finish, 23 at the time limit.
    """
    from scenarios.mission import RunOptions, run_and_report

    run_and_report(
        scenario,
        RunOptions(
            seed=seed,
            strategy=strategy,
            service=service,
            key=key,
            headless=headless,
            json_file=json_file,
            report=report,
            movie=movie,
            out=out,
        ),
    )
