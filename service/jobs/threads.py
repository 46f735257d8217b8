"""Planning in threads: the native planner lets other threads run while it searches."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

A = TypeVar("A")
R = TypeVar("R")


class PlanningThreads:
    """The `Planners` port on a thread pool."""

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._under_way = 0
        self._pool = ThreadPoolExecutor(workers, thread_name_prefix="planning")

    async def run(self, function: Callable[[A], R], argument: A) -> R:
        """`function(argument)` in a worker thread."""
        self._under_way += 1
        try:
            return await asyncio.get_running_loop().run_in_executor(self._pool, function, argument)
        finally:
            self._under_way -= 1

    @property
    def load(self) -> float:
        """Computations under way or waiting, for each worker."""
        return self._under_way / self._workers

    def close(self) -> None:
        """Lets the workers finish what they are at."""
        self._pool.shutdown(wait=True, cancel_futures=True)
