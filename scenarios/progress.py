"""How a running mission shows itself: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from scenarios.report.markup import clock
from simulator.simulation import Progress

Listener = Callable[[Progress], None]
LINE_EVERY_S = 60.0
"""simulated time between two plain lines"""


@contextmanager
def shown(*, headless: bool) -> Iterator[Listener]:
    """A listener for the progress of a simulation, alive while the mission runs."""
    if headless:
        yield lambda _: None
    elif sys.stderr.isatty():
        with _bar() as listener:
            yield listener
    else:
        yield _lines()


@contextmanager
def _bar() -> Iterator[Listener]:
    from rich import progress as rich
    from rich.console import Console

    with rich.Progress(
        rich.TextColumn("[bold]targets"),
        rich.BarColumn(bar_width=30),
        rich.TextColumn("{task.completed:.0f}/{task.total:.0f}"),
        rich.TextColumn("{task.fields[state]}", style="dim"),
        rich.TimeElapsedColumn(),
        console=Console(stderr=True),
    ) as bar:
        task = bar.add_task("", total=None, state="")

        def listener(now: Progress) -> None:
            visited = now.targets - now.targets_left
            bar.update(task, total=now.targets, completed=visited, state=state(now))

        yield listener


def _lines() -> Listener:
    due_s = [0.0]

    def listener(now: Progress) -> None:
        over = now.status in ("completed", "failed", "canceled")
        if now.time_s >= due_s[0] or over:
            due_s[0] = now.time_s + LINE_EVERY_S
            sys.stderr.write(f"{now.targets_left} of {now.targets} targets left, {state(now)}\n")
            sys.stderr.flush()

    return listener


def state(now: Progress) -> str:
    """Blockades, time and replans in a few words."""
    return (
        f"{now.blockades_known} blockades known, {now.blockades_cleared} cleared, "
        f"{clock(now.time_s)} simulated, {now.replans} replans"
    )
