"""How a running mission shows itself: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from scenarios.recorder import Recorder
from scenarios.report.markup import clock

Listener = Callable[[Recorder], None]
LINE_EVERY_S = 60.0
"""simulated time between two plain lines"""


@contextmanager
def shown(targets: int, *, headless: bool) -> Iterator[Listener | None]:
    """A listener for a recorder, alive while the mission runs."""
    if headless:
        yield None
    elif sys.stderr.isatty():
        with _bar(targets) as listener:
            yield listener
    else:
        yield _lines(targets)


@contextmanager
def _bar(targets: int) -> Iterator[Listener]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    with Progress(
        TextColumn("[bold]targets"),
        BarColumn(bar_width=30),
        TextColumn("{task.completed:.0f}/{task.total:.0f}"),
        TextColumn("{task.fields[state]}", style="dim"),
        TimeElapsedColumn(),
        console=Console(stderr=True),
    ) as progress:
        task = progress.add_task("", total=targets, state="")

        def listener(recorder: Recorder) -> None:
            left = recorder.answer["targets_left"] if recorder.answer else targets
            progress.update(task, completed=targets - left, state=_state(recorder))

        yield listener


def _lines(targets: int) -> Listener:
    last = [-LINE_EVERY_S]

    def listener(recorder: Recorder) -> None:
        if recorder.time_s - last[0] < LINE_EVERY_S:
            return
        last[0] = recorder.time_s
        left = recorder.answer["targets_left"] if recorder.answer else targets
        sys.stderr.write(f"targets left {left}/{targets}, {_state(recorder)}\n")
        sys.stderr.flush()

    return listener


def _state(recorder: Recorder) -> str:
    replans = recorder.answer["replans"] if recorder.answer else 0
    return (
        f"{len(recorder.seen_at_s)} blockades known, "
        f"{clock(recorder.time_s)} simulated, {replans} replans"
    )
