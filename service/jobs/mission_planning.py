"""Mission planning on an executor: workers that can be killed, and may be lost."""

import asyncio
import logging

from service.coordination.deliberation import Decided, Deliberation
from service.coordination.ports import PlannersLostError
from service.coordination.strategy import NoPlanError
from service.jobs.demand import Demand
from service.jobs.executor import Executor, QueueFullError, Told

LOG = logging.getLogger(__name__)


class MissionPlanning:
    """The `Planners` port on an executor."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._demand = Demand(executor.capacity().workers)

    async def decide(self, deliberation: Deliberation) -> Decided:
        """The decision of a worker.

        Where a worker is lost, the strategy's fallback has another try: what killed one worker may
        kill the next, and a team in the field is better off with a simple order than with none.
        """
        self._demand.ask(deliberation.mission_id)
        told = await self._told(deliberation)
        if _is_lost(told):
            LOG.warning("mission %s: %s", deliberation.mission_id, told["message"])
            told = await self._told(deliberation.simpler())
        if told["kind"] == "finished":
            decided: Decided = told["decided"]
            return decided
        message = told.get("message", "the decision was canceled")
        if told.get("outcome") == "no_plan":
            raise NoPlanError(message)
        if told.get("outcome") == "faulty":
            raise RuntimeError(message)
        raise PlannersLostError(message)

    async def _told(self, deliberation: Deliberation) -> Told:
        """How the work ended."""
        try:
            run = self._executor.submit(
                deliberation,
                client=deliberation.fleet,
                priority=deliberation.situation.planning.priority,
            )
        except QueueFullError as error:
            raise PlannersLostError(str(error)) from None
        try:
            return [told async for told in run.told()][-1]
        except asyncio.CancelledError:
            run.cancel()
            raise

    def forget(self, mission_id: str) -> None:
        """A mission has ended."""
        self._executor.forget(mission_id)

    @property
    def share_s(self) -> float:
        """Time for each decision so that all missions get theirs soon [s]."""
        return self._demand.share_s(self._executor.capacity().queued)


def _is_lost(told: Told) -> bool:
    return told["kind"] == "failed" and told.get("outcome") in ("crashed", "timed_out")
