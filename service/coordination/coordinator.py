"""One mission's loop (thesis 3.3, figure 3.2): reports in, facts found, replanned, commands out."""

import asyncio
from collections.abc import Callable, Mapping, Sequence

from semantic_attachments.world import GridMap, RobotModel
from service.coordination import facts
from service.coordination.admission import report_faults
from service.coordination.events import CommandGivenUp, Event, ReportAccepted, RobotLost
from service.coordination.ledger import Ledger
from service.coordination.mission import Mission
from service.coordination.ports import EventLog, Fault, Observer, Planners
from service.coordination.replanning import LoopParameters, Replanning
from service.coordination.strategy import Strategy
from service.messages.report import MissionSummary, Report, ReportAnswer


class ReportRefusedError(Exception):
    """A report that the mission cannot accept."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        super().__init__(faults[0][1])
        self.faults = list(faults)


class OverError(Exception):
    """The mission has reached its terminal state."""


class Coordinator:
    """Keeps one mission going."""

    def __init__(
        self,
        mission: Mission,
        *,
        models: Mapping[str, RobotModel],
        strategy: Strategy,
        log: EventLog,
        planners: Planners,
        parameters: LoopParameters,
        observer: Observer,
    ) -> None:
        self._ledger = Ledger(mission, log)
        self._parameters = parameters
        self._replanning = Replanning(
            self._ledger,
            models=models,
            strategy=strategy,
            planners=planners,
            parameters=parameters,
            observer=observer,
        )
        self._late: set[str] = set()

    @property
    def mission(self) -> Mission:
        """The mission as it is now."""
        return self._ledger.mission

    @property
    def grid(self) -> GridMap:
        """Its map, without blockades."""
        return self.mission.map.grid

    # Facts in

    async def report(self, report: Report, wait_s: float = 0.0) -> ReportAnswer:
        """Accepts a report, once; answers with the commands in force.

        Args:
            wait_s: how long to wait for the replan that the report gives cause for.

        Raises:
            ReportRefusedError: it speaks of robots or commands that the mission does not know.
        """
        # Shielded: a client that hangs up must not stop a report half way to the log.
        await asyncio.shield(asyncio.ensure_future(self._accept(report)))
        if wait_s > 0.0:
            await self.settle(wait_s)
        return self.answer()

    async def _accept(self, report: Report) -> None:
        async with self._ledger.locked() as mission:
            if not mission.is_new(report.sequence):
                return
            if faults := report_faults(mission, report):
                raise ReportRefusedError(faults)
            if mission.is_over:
                return
            found = facts.facts_in(mission, report)
            await self._ledger.record([ReportAccepted(report=report)])
            found += await self._look_around()
            if mission.is_accomplished:
                await self._ledger.close("completed", "every target is visited")
            elif facts.is_hopeless(mission, self._parameters.hopeless_s):
                await self._ledger.close(
                    "failed",
                    f"{mission.status_reason}; nothing has changed for "
                    f"{self._parameters.hopeless_s:g} s",
                )
            elif found:
                self._replanning.ask(found)

    async def _look_around(self) -> list[str]:
        """Facts that no report states: robots late, silent or without work."""
        mission = self.mission
        found = []
        for robot_id in facts.silent_robots(mission):
            await self._ledger.record([RobotLost(time_s=mission.time_s, robot=robot_id)])
            found.append(f"{robot_id} fell silent")
        for robot_id in facts.stuck_robots(mission, self._parameters.give_up_s):
            reason = f"it is more than {self._parameters.give_up_s:g} s late and stands still"
            command = mission.commands[robot_id]
            await self._ledger.record(
                [
                    CommandGivenUp(
                        time_s=mission.time_s, robot=robot_id, command=command.id, reason=reason
                    )
                ]
            )
            found.append(f"{robot_id} does not get on with {command.kind} {command.location}")
        late = [
            robot_id
            for robot_id in facts.late_robots(mission)
            if mission.commands[robot_id].id not in self._late
        ]
        self._late |= {mission.commands[robot_id].id for robot_id in late}
        found += [f"{robot_id} is late" for robot_id in late]
        has_work = facts.is_idle(mission) or mission.status == "delayed"
        if (
            has_work
            and mission.time_s - self._replanning.looked_at_s >= self._parameters.idle_replan_s
        ):
            found.append("a robot is idle")
        return found

    def replan(self, reason: str) -> None:
        """Asks for a replan, for instance after a restart."""
        if not self.mission.is_over:
            self._replanning.ask([reason])

    async def change(self, draft: Callable[[Mission], Event | None]) -> None:
        """Changes the mission at somebody's wish, and replans.

        Args:
            draft: what shall happen, drawn up under the lock; None if it is so already.

        Raises:
            OverError: the mission has ended.
        """
        await asyncio.shield(asyncio.ensure_future(self._change(draft)))

    async def _change(self, draft: Callable[[Mission], Event | None]) -> None:
        async with self._ledger.locked() as mission:
            if mission.is_over:
                raise OverError(f"the mission has ended: {mission.status}")
            event = draft(mission)
            if event is None:
                return
            await self._ledger.record([event])
            if mission.is_accomplished:
                await self._ledger.close("completed", "every target that is left is visited")
            elif mission.status != "queued":
                self._replanning.ask(
                    [mission.decisions[-1].kind + " " + mission.decisions[-1].reason]
                )

    async def cancel(self, reason: str) -> None:
        """Ends the mission; one that is canceled already stays as it is.

        Raises:
            OverError: the mission has ended otherwise.
        """
        await asyncio.shield(asyncio.ensure_future(self._cancel(reason)))

    async def _cancel(self, reason: str) -> None:
        async with self._ledger.locked() as mission:
            if mission.is_over and mission.status != "canceled":
                raise OverError(f"the mission has ended: {mission.status}")
            if not mission.is_over:
                await self._ledger.close("canceled", reason)

    async def settle(self, timeout_s: float) -> None:
        """Waits until no replan is under way, but not longer than that."""
        await self._replanning.settle(timeout_s)

    async def stop(self) -> None:
        """Lets go of the mission; it stays in the log as it is."""
        await self._replanning.stop()

    # Commands out

    async def news(self, after: int, timeout_s: float) -> bool:
        """Waits until the mission has more than `after` events; false if it has not in time."""
        return await self._ledger.news(after, timeout_s)

    def hush(self) -> None:
        """Sends all listeners away: the service is to stop."""
        self._ledger.hush()

    def latest(self, first_number: int) -> list[tuple[int, Event]]:
        """The events from `first_number` on with their numbers; empty if they are not at hand."""
        return self._ledger.latest(first_number)

    def answer(self) -> ReportAnswer:
        """The commands in force."""
        mission = self.mission
        return ReportAnswer(
            mission=summary(mission),
            commands=[mission.commands[robot] for robot in sorted(mission.commands)],
        )


def summary(mission: Mission) -> MissionSummary:
    """The mission in short."""
    return MissionSummary(
        id=mission.id,
        status=mission.status,
        revision=mission.revision,
        sequence=mission.sequence,
        targets_left=mission.targets_left,
        replans=mission.replans,
    )
