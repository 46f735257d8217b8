"""Mission planning in threads: the native planner lets other threads run while it searches.

For a service in its client's process (batch runs, tests), where a crash costs no fleet its
coordination. Nothing stops a thread that takes too long.
"""

import asyncio
from concurrent.futures import ThreadPoolExecutor

from semantic_attachments.contract import Memory
from service.coordination.deliberation import Decided, Deliberation
from service.jobs.demand import Demand


class PlanningThreads:
    """The `Planners` port on a thread pool."""

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._under_way = 0
        self._demand = Demand(workers)
        self._pool = ThreadPoolExecutor(workers, thread_name_prefix="planning")
        self._memories: dict[str, Memory] = {}

    async def decide(self, deliberation: Deliberation) -> Decided:
        """The decision, made in a worker thread."""
        memory = self._memories.setdefault(deliberation.mission_id, Memory())
        self._under_way += 1
        self._demand.ask(deliberation.mission_id)
        try:
            loop = asyncio.get_running_loop()
            return await loop.run_in_executor(self._pool, deliberation.decide, memory)
        finally:
            self._under_way -= 1

    def forget(self, mission_id: str) -> None:
        """A mission has ended."""
        self._memories.pop(mission_id, None)

    @property
    def share_s(self) -> float:
        """Time for each decision so that all missions get theirs soon [s]."""
        return self._demand.share_s(max(self._under_way - self._workers, 0))

    def close(self) -> None:
        """Lets the workers finish what they are at."""
        self._pool.shutdown(wait=True, cancel_futures=True)
