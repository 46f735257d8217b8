"""Simulated time: whole steps, so that a seed repeats to the bit."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Clock:
    """Counts steps of a fixed length; never the wall clock."""

    step_s: float = 0.05
    steps: int = 0

    @property
    def time_s(self) -> float:
        """Seconds since the mission began."""
        return self.steps * self.step_s

    def advance(self) -> None:
        """One step on."""
        self.steps += 1

    def every(self, period_s: float, offset: int = 0) -> bool:
        """Whether an action with that period is due in this step; offsets spread the load."""
        period = max(1, round(period_s / self.step_s))
        return (self.steps + offset) % period == 0
