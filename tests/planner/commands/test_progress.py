"""The progress line, on a real pseudo-terminal."""

import fcntl
import os
import pty
import select
import struct
import termios
from collections.abc import Iterator
from typing import TextIO

import pytest

from planner import Plan, Step
from planner.commands.progress import Display, gap
from planner.solving import Progress

PLAN = Plan((Step(0.0, "go", ("a",), 20.0),), "d", "p")
COLUMNS = 60


@pytest.fixture
def terminal() -> Iterator[tuple[int, TextIO]]:
    """The reading end, and the narrow terminal written to."""
    reader, writer = pty.openpty()
    fcntl.ioctl(writer, termios.TIOCSWINSZ, struct.pack("HHHH", 24, COLUMNS, 0, 0))
    with os.fdopen(writer, "w") as stream:
        yield reader, stream
    os.close(reader)


def everything(reader: int) -> str:
    """All that was written; a terminal hands it over in parts."""
    written = b""
    while select.select([reader], [], [], 0.3)[0]:
        written += os.read(reader, 10_000)
    return written.decode()


def test_one_line_is_rewritten_and_never_wider_than_the_terminal(
    terminal: tuple[int, TextIO],
) -> None:
    reader, stream = terminal
    display = Display(stream)
    display.plan(PLAN)
    display.progress(Progress(states=123_456_789, lower_bound=15.0))
    display.progress(Progress(states=987_654_321, lower_bound=16.0))
    display.close()
    written = everything(reader)
    assert "\n" not in written
    lines = written.split("\r\x1b[K")
    assert lines[0] == lines[-1] == ""
    assert "best 20.00 s, gap 25.0 %, bound 15.00 s" in lines[1]
    assert "gap 20.0 %, bound 16.00 s" in lines[2]
    assert all(len(line) < COLUMNS for line in lines)


def test_watching_shows_every_plan_on_a_line_of_its_own(terminal: tuple[int, TextIO]) -> None:
    reader, stream = terminal
    display = Display(stream, every_plan=True)
    display.progress(Progress(states=1, lower_bound=15.0))
    display.plan(PLAN)
    display.close()
    written = everything(reader)
    assert "no plan yet" in written
    assert "plan 1: makespan 20.000 s, 1 steps" in written


def test_the_gap_needs_a_bound() -> None:
    assert gap(20.0, 15.0) == "25.0 %"
    assert gap(20.0, 0.0) == "?"
