"""A mission played again on a terminal: the map in characters, what is decided below it."""

from __future__ import annotations

import sys
import time
from collections import deque
from collections.abc import Sequence

import numpy as np
from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from scenarios.replay.record import Moment, moments
from scenarios.report.map_figure import short
from scenarios.report.markup import clock
from service.coordination.events import Event, ReportAccepted
from service.coordination.mission import Mission
from service.messages.plan import Decision

COLOURS = ("cyan", "magenta", "green", "yellow", "blue", "red", "bright_cyan", "bright_magenta")
DECISIONS_SHOWN = 6
OCCUPIED_FROM = 65
FRAMES_A_SECOND = 12.0


def play(events: Sequence[Event], speed: float) -> None:
    """Plays a mission: moving on a terminal, one line a decision elsewhere.

    Args:
        speed: mission seconds a second; 0 for as fast as it goes.
    """
    if sys.stdout.isatty():
        _on_terminal(events, speed)
    else:
        for line in lines(events):
            print(line)


def lines(events: Sequence[Event]) -> list[str]:
    """A line for each decision, and one for the end."""
    told = []
    mission = None
    for moment in moments(events):
        mission = moment.mission
        told += [decided(decision) for decision in moment.decisions]
    if mission is not None:
        told.append(state(mission))
    return told


def decided(decision: Decision) -> str:
    """A decision in a line."""
    return f"{clock(decision.time_s):>6}  {decision.kind}: {decision.reason}"


def state(mission: Mission) -> str:
    """Where a mission stands, in a line."""
    visited = sum(target.visited_by is not None for target in mission.targets.values())
    why = f" ({mission.status_reason})" if mission.status_reason else ""
    return (
        f"{clock(mission.time_s):>6}  {mission.status}{why}: {visited} of {len(mission.targets)} "
        f"targets visited, plan {mission.revision}"
    )


def _on_terminal(events: Sequence[Event], speed: float) -> None:
    console = Console()
    latest: deque[Decision] = deque(maxlen=DECISIONS_SHOWN)
    begun_s, shown_s = time.monotonic(), -1.0
    with Live(console=console, auto_refresh=False) as live:
        for moment in moments(events):
            latest.extend(moment.decisions)
            if not _is_frame(moment):
                continue
            now_s = moment.mission.time_s
            if speed > 0:
                time.sleep(max(0.0, begun_s + now_s / speed - time.monotonic()))
            if time.monotonic() - shown_s >= 1.0 / FRAMES_A_SECOND or moment.mission.is_over:
                shown_s = time.monotonic()
                live.update(frame(moment.mission, latest, console.width, console.height))
                live.refresh()


def _is_frame(moment: Moment) -> bool:
    return isinstance(moment.event, ReportAccepted) or moment.mission.is_over


def frame(mission: Mission, latest: Sequence[Decision], width: int, height: int) -> Group:
    """One picture of a mission."""
    rows = max(8, height - DECISIONS_SHOWN - 4)
    texts = [Text(decided(decision), style="dim", no_wrap=True) for decision in latest]
    return Group(Text(state(mission), style="bold"), picture(mission, width, rows), *texts)


def picture(mission: Mission, width: int, height: int) -> Text:
    """The map in `width` x `height` characters at most; a character is twice as high as wide."""
    grid = mission.map.grid
    step = max(grid.width / max(width - 1, 1), grid.height / (2.0 * max(height, 1)), 1.0)
    columns, rows = int(np.ceil(grid.width / step)), int(np.ceil(grid.height / (2.0 * step)))
    letters = np.full((rows, columns), " ", dtype="<U1")
    styles = np.full((rows, columns), "", dtype="<U20")
    for value, letter, style in ((-1, "·", "dim"), (0, " ", ""), (100, "█", "bright_black")):
        mask = {-1: grid.cells < 0, 0: grid.cells == 0, 100: grid.cells >= OCCUPIED_FROM}[value]
        found = np.argwhere(mask)
        at = (rows - 1 - (found[:, 0] / (2.0 * step)).astype(int), (found[:, 1] / step).astype(int))
        letters[at], styles[at] = letter, style

    def put(position_m: tuple[float, float], letter: str, style: str) -> None:
        column = int((position_m[0] - grid.origin_m[0]) / grid.resolution_m / step)
        row = rows - 1 - int((position_m[1] - grid.origin_m[1]) / grid.resolution_m / (2.0 * step))
        if 0 <= row < rows and 0 <= column < columns:
            letters[row, column], styles[row, column] = letter, style

    for blockade in mission.blockades.values():
        if blockade.cleared_by is None:
            for share in np.linspace(0.0, 1.0, 12):
                (x0, y0), (x1, y1) = blockade.segment_m
                put((x0 + share * (x1 - x0), y0 + share * (y1 - y0)), "#", "bold red")
    for target in mission.targets.values():
        if not target.removed:
            visited = target.visited_by is not None
            put(target.position_m, "✓" if visited else "○", "green" if visited else "bold yellow")
    for index, robot in enumerate(mission.robots.values()):
        style = "dim" if not robot.takes_part else f"bold {COLOURS[index % len(COLOURS)]}"
        put(robot.position_m, short(robot.id)[0], style)
    text = Text(no_wrap=True)
    for row in range(rows):
        for column in range(columns):
            text.append(str(letters[row, column]), style=str(styles[row, column]) or None)
        text.append("\n")
    return text
