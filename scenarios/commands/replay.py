"""`marsupial replay`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def replay(
    mission: Annotated[
        str, typer.Argument(help="A mission's id, the start of it, or `latest`.")
    ] = "latest",
    *,
    db: Annotated[
        str | None,
        typer.Option(help="Database of the service.", show_default="sqlite:///marsupial.sqlite"),
    ] = None,
    service: Annotated[
        str | None, typer.Option(help="Address of a running service, instead of a database.")
    ] = None,
    key: Annotated[
        str | None, typer.Option(envvar="MARSUPIAL_KEY", help="API key for that service.")
    ] = None,
    speed: Annotated[
        float, typer.Option(min=0.0, help="Mission seconds a second; 0 does not wait.")
    ] = 20.0,
    report: Annotated[
        Path | None, typer.Option(help="Write the HTML report to this file.", show_default="out/")
    ] = None,
    headless: Annotated[
        bool, typer.Option("--headless", help="Write the report and play nothing.")
    ] = False,
) -> None:
    """Play a mission again from its event log: on the terminal, and as an HTML report.

    The log keeps every report, plan and command: what is shown is what the service knew. Where the
    output is no terminal, each decision is a line.
    """
    from scenarios.replay.log import events_of
    from scenarios.replay.record import record_of
    from scenarios.replay.stage import play
    from scenarios.report.page import write_report

    events = events_of(mission, db=db, service=service, key=key)
    if not headless:
        play(events, speed)
    record, ground = record_of(events)
    path = write_report(report or Path("out") / f"mission-{record.mission}.html", record, ground)
    print(f"report: {path.resolve()}")
