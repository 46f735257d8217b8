"""What a user sees while the planner searches: one line that is rewritten, or one line a plan."""

import os
import sys
import time
from typing import TextIO

from planner.plan import Plan
from planner.solving import Progress


def gap(cost: float, bound: float) -> str:
    """How much better an optimal plan could be, in percent of the best one."""
    return f"{100 * max(0.0, 1 - bound / cost):.1f} %" if cost > 0 and bound > 0 else "?"


class Display:
    """Writes to stderr: a progress line on a terminal, elsewhere a line for every plan."""

    def __init__(self, stream: TextIO | None = None, *, every_plan: bool = False) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._live = self._stream.isatty()
        self._every_plan = every_plan or not self._live
        self._begun = time.monotonic()
        self._plans = 0
        self._best: Plan | None = None
        self._last = (self._begun, 0)
        self._rate = 0.0

    def plan(self, plan: Plan) -> None:
        """Shows an improving plan."""
        self._plans += 1
        self._best = plan
        if self._every_plan:
            self._clear()
            metric = "" if plan.metric is None else f", metric {plan.metric:g}"
            self._stream.write(
                f"plan {self._plans}: makespan {plan.makespan:.3f} s{metric}, {len(plan)} steps, "
                f"found after {plan.wall_s or 0:.3f} s ({plan.cpu_s or 0:.3f} s CPU)\n"
            )
            self._stream.flush()

    def progress(self, progress: Progress) -> None:
        """Rewrites the progress line."""
        if not self._live:
            return
        now = time.monotonic()
        before, states = self._last
        if now - before >= 0.5:
            self._rate = (progress.states - states) / (now - before)
            self._last = (now, progress.states)
        best = "no plan yet"
        if self._best is not None:
            cost = self._best.makespan
            best = f"best {cost:.2f} s, gap {gap(cost, progress.lower_bound)}"
        self._clear()
        line = (
            f"{now - self._begun:5.1f} s  {best}, bound {progress.lower_bound:.2f} s  "
            f"{self._plans} plans, {progress.states:,} states, {self._rate:,.0f}/s"
        )
        # A line that is broken in two cannot be rewritten.
        self._stream.write(line[: _columns(self._stream) - 1])
        self._stream.flush()

    def close(self) -> None:
        """Removes the progress line."""
        self._clear()
        self._stream.flush()

    def _clear(self) -> None:
        if self._live:
            self._stream.write("\r\x1b[K")


def _columns(stream: TextIO) -> int:
    """Width of a terminal; 80 where it does not tell."""
    try:
        return os.get_terminal_size(stream.fileno()).columns or 80
    except OSError:
        return 80
