"""How much time a decision may take when many missions want theirs."""

import time
from collections import deque
from collections.abc import Callable
from math import inf

WINDOW_S = 10.0
UTILIZATION = 0.5
"""Part of the workers' time that searches may fill: the rest keeps queues short."""


class Demand:
    """Counts what is asked for, and shares the workers' time."""

    def __init__(self, workers: int, now_s: Callable[[], float] = time.monotonic) -> None:
        self._workers = workers
        self._now_s = now_s
        self._asked: deque[tuple[float, str]] = deque()

    def ask(self, mission_id: str) -> None:
        """A mission wants a decision."""
        self._asked.append((self._now_s(), mission_id))

    def share_s(self, waiting: int) -> float:
        """Time for each decision so that the workers keep up [s]; infinite if all have one.

        Args:
            waiting: decisions that wait for a worker now.
        """
        now_s = self._now_s()
        while self._asked and self._asked[0][0] < now_s - WINDOW_S:
            self._asked.popleft()
        if len({mission_id for _, mission_id in self._asked}) <= self._workers:
            return inf  # a mission has one decision under way at most
        steady_s = UTILIZATION * self._workers * WINDOW_S / len(self._asked)
        return steady_s / (1.0 + waiting / self._workers)
