"""One mission's loop (thesis 3.3, figure 3.2): reports in, facts found, replanned, commands out.

Events are stored first and applied then, under one lock, so that the mission in memory never knows
more than its log. Planning runs elsewhere on a frozen snapshot while reports go on; what has become
pointless in the meantime is left out when the proposal is turned into commands.
"""

import asyncio
import logging
import time
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass, replace

from semantic_attachments.contract import Memory
from semantic_attachments.world import GridMap, RobotModel
from service.coordination import dispatch, facts
from service.coordination.admission import Fault, report_faults
from service.coordination.events import (
    CommandGivenUp,
    Event,
    MissionClosed,
    OrdersIssued,
    PlanKept,
    PlanningFailed,
    ReportAccepted,
    RobotLost,
    TerminalStatus,
)
from service.coordination.meeting_points import meeting_points
from service.coordination.mission import Mission, rebuilt
from service.coordination.ports import EventLog, Observer, Planners, StoreError
from service.coordination.situation import situation
from service.coordination.strategy import NoPlanError, Proposal, Situation, Strategy
from service.messages.mission import PlanningMessage
from service.messages.report import Command, MissionSummary, Report, ReportAnswer

LOG = logging.getLogger(__name__)


class ReportRefusedError(Exception):
    """A report that the mission cannot accept."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        super().__init__(faults[0][1])
        self.faults = list(faults)


class OverError(Exception):
    """The mission has reached its terminal state."""


@dataclass(frozen=True)
class LoopParameters:
    """How the loop paces itself."""

    debounce_s: float = 0.05
    """Facts within this time share one replan, unless somebody waits [wall clock]."""
    idle_replan_s: float = 30.0
    """An idle robot gets a fresh look after this time [fleet clock]."""
    give_up_s: float = 60.0
    """A robot that is late by that much and stands still has failed its command [fleet clock]."""
    hopeless_s: float = 300.0
    """A mission fails when for so long the team could do nothing [fleet clock]."""
    retry_s: float = 1.0
    """When to try again after the log refused [wall clock]."""


class Coordinator:
    """Keeps one mission going."""

    def __init__(
        self,
        mission: Mission,
        *,
        grid: GridMap,
        models: Mapping[str, RobotModel],
        strategy: Strategy,
        log: EventLog,
        planners: Planners,
        parameters: LoopParameters,
        observer: Observer,
    ) -> None:
        self.mission = mission
        self.grid = grid
        self._models = models
        self._meeting_points = meeting_points(grid, models)
        self._strategy = strategy
        self._log = log
        self._planners = planners
        self._parameters = parameters
        self._observer = observer
        self._memory = Memory()
        self._lock = asyncio.Lock()
        self._facts: list[str] = []
        self._facts_since_s = 0.0
        self._replanning: asyncio.Task[None] | None = None
        self._quiet = asyncio.Event()
        self._quiet.set()
        self._waiters = 0
        self._looked_at_s = 0.0
        self._late: set[str] = set()
        self._in_doubt = False
        self._news = asyncio.Event()

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
        async with self._locked():
            mission = self.mission
            if not mission.is_new(report.sequence):
                return
            if faults := report_faults(mission, report):
                raise ReportRefusedError(faults)
            if mission.is_over:
                return
            found = facts.facts_in(mission, report)
            await self._record([ReportAccepted(report=report)])
            found += await self._look_around()
            if mission.is_accomplished:
                await self._close("completed", "every target is visited")
            elif facts.is_hopeless(mission, self._parameters.hopeless_s):
                await self._close(
                    "failed",
                    f"{mission.status_reason}; nothing has changed for "
                    f"{self._parameters.hopeless_s:g} s",
                )
            elif found:
                self._replan_for(found)

    async def _look_around(self) -> list[str]:
        """Facts that no report states: robots late, silent or without work."""
        mission = self.mission
        found = []
        for robot_id in facts.silent_robots(mission):
            await self._record([RobotLost(time_s=mission.time_s, robot=robot_id)])
            found.append(f"{robot_id} fell silent")
        for robot_id in facts.stuck_robots(mission, self._parameters.give_up_s):
            reason = f"it is more than {self._parameters.give_up_s:g} s late and stands still"
            command = mission.commands[robot_id]
            await self._record(
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
        if has_work and mission.time_s - self._looked_at_s >= self._parameters.idle_replan_s:
            found.append("a robot is idle")
        return found

    def replan(self, reason: str) -> None:
        """Asks for a replan, for instance after a restart."""
        if not self.mission.is_over:
            self._replan_for([reason])

    async def change(self, draft: Callable[[Mission], Event | None]) -> None:
        """Changes the mission at somebody's wish, and replans.

        Args:
            draft: what shall happen, drawn up under the lock; None if it is so already.

        Raises:
            OverError: the mission has ended.
        """
        await asyncio.shield(asyncio.ensure_future(self._change(draft)))

    async def _change(self, draft: Callable[[Mission], Event | None]) -> None:
        async with self._locked():
            mission = self.mission
            if mission.is_over:
                raise OverError(f"the mission has ended: {mission.status}")
            event = draft(mission)
            if event is None:
                return
            await self._record([event])
            if mission.is_accomplished:
                await self._close("completed", "every target that is left is visited")
            elif mission.status != "queued":
                self._replan_for([mission.decisions[-1].kind + " " + mission.decisions[-1].reason])

    async def cancel(self, reason: str) -> None:
        """Ends the mission; one that is canceled already stays as it is.

        Raises:
            OverError: the mission has ended otherwise.
        """
        await asyncio.shield(asyncio.ensure_future(self._cancel(reason)))

    async def _cancel(self, reason: str) -> None:
        async with self._locked():
            if self.mission.is_over and self.mission.status != "canceled":
                raise OverError(f"the mission has ended: {self.mission.status}")
            if not self.mission.is_over:
                await self._close("canceled", reason)

    async def settle(self, timeout_s: float) -> None:
        """Waits until no replan is under way, but not longer than that."""
        self._waiters += 1
        try:
            with suppress(TimeoutError):
                await asyncio.wait_for(self._quiet.wait(), timeout_s)
        finally:
            self._waiters -= 1

    async def stop(self) -> None:
        """Lets go of the mission; it stays in the log as it is."""
        if self._replanning is not None:
            self._replanning.cancel()
            with suppress(asyncio.CancelledError):
                await self._replanning

    # Commands out

    async def news(self, after: int, timeout_s: float) -> bool:
        """Waits until the mission has more than `after` events; false if it has not in time."""
        deadline = asyncio.get_running_loop().time() + timeout_s
        while self.mission.events <= after:
            left_s = deadline - asyncio.get_running_loop().time()
            try:
                await asyncio.wait_for(self._news.wait(), max(left_s, 0.0))
            except TimeoutError:
                return False
        return True

    def answer(self) -> ReportAnswer:
        """The commands in force."""
        mission = self.mission
        return ReportAnswer(
            mission=summary(mission),
            commands=[mission.commands[robot] for robot in sorted(mission.commands)],
        )

    # Replanning

    def _replan_for(self, found: Sequence[str]) -> None:
        if not self._facts:
            self._facts_since_s = time.monotonic()
        self._observer.noticed(len(found))
        self._facts += found
        self._quiet.clear()
        if self._replanning is None or self._replanning.done():
            self._replanning = asyncio.get_running_loop().create_task(self._replan_until_quiet())

    async def _replan_until_quiet(self) -> None:
        try:
            while self._facts and not self.mission.is_over:
                if self._waiters == 0:
                    await asyncio.sleep(self._parameters.debounce_s)
                found, self._facts = self._facts, []
                since_s = self._facts_since_s
                try:
                    outcome = await self._replan_once("; ".join(dict.fromkeys(found)))
                    self._observe(outcome, time.monotonic() - since_s)
                except StoreError as error:
                    LOG.error("mission %s: %s; trying again", self.mission.id, error)
                    self._facts = found + self._facts
                    await asyncio.sleep(self._parameters.retry_s)
        finally:
            self._quiet.set()

    def _observe(self, outcome: str, duration_s: float) -> None:
        plan = self.mission.plan if outcome == "new plan" else None
        makespan_s = None if plan is None else plan.end_s - plan.adopted_at_s
        self._observer.replanned(outcome, duration_s, makespan_s)

    async def _replan_once(self, trigger: str) -> str:
        async with self._locked():
            snapshot = situation(
                self.mission, self.grid, self._models, self._meeting_points, trigger
            )
            events = self.mission.events
        self._looked_at_s = snapshot.state.time_s
        snapshot = replace(snapshot, planning=within_load(snapshot.planning, self._planners.load))
        return await self._decide(snapshot, events)

    async def _decide(self, snapshot: Situation, events: int) -> str:
        """How the decision on a snapshot of that many events ended, in a word or two."""
        hopeless = False
        try:
            decision = await self._planners.run(
                Deliberation(self._strategy, self._memory), snapshot
            )
        except NoPlanError as error:
            outcome: Decided | str = f"{snapshot.trigger}: {error}"
            hopeless = True
        except Exception as error:
            LOG.exception("mission %s: the strategy failed", self.mission.id)
            outcome = f"{snapshot.trigger}: the strategy failed: {error}"
        else:
            outcome = decision
        async with self._locked():
            if self.mission.is_over:
                return "mission over"
            if isinstance(outcome, str):
                time_s = self.mission.time_s
                # What has happened in the meantime gives hope.
                hopeless = hopeless and not self._facts
                await self._record(
                    [PlanningFailed(time_s=time_s, reason=outcome, hopeless=hopeless)]
                )
                return "no plan"
            return await self._adopt(snapshot, events, outcome)

    async def _adopt(self, snapshot: Situation, events: int, decided: "Decided") -> str:
        mission, proposal = self.mission, decided.proposal
        revision = mission.revision + 1
        commands = dispatch.commands(mission, decided.orders, revision)
        reason = f"{snapshot.trigger}: {proposal.reason}"
        if proposal.keeps_plan and _unchanged(mission, commands):
            await self._record([PlanKept(time_s=mission.time_s, reason=reason)])
            return "plan kept"
        await self._record(
            [
                OrdersIssued(
                    time_s=mission.time_s,
                    revision=revision,
                    reason=reason,
                    commands=commands,
                    new_plan=not proposal.keeps_plan,
                    steps=[] if proposal.keeps_plan else list(proposal.steps),
                    validated=proposal.validated,
                    remarks=dict(proposal.remarks),
                    done=[] if proposal.keeps_plan else mission.done[len(snapshot.done) :],
                    disturbed=mission.disturbed_by > events,
                )
            ]
        )
        return "next steps" if proposal.keeps_plan else "new plan"

    async def _close(self, status: TerminalStatus, reason: str) -> None:
        await self._record(
            [MissionClosed(time_s=self.mission.time_s, status=status, reason=reason)]
        )

    @asynccontextmanager
    async def _locked(self) -> AsyncIterator[None]:
        async with self._lock:
            if self._in_doubt:
                self.mission = await asyncio.to_thread(rebuilt, self._log.events(self.mission.id))
                self._in_doubt = False
            yield

    async def _record(self, events: Sequence[Event]) -> None:
        try:
            await self._log.append(self.mission.id, self.mission.events, events)
        except StoreError:
            # A commit whose answer was lost may have happened: the log decides.
            self._in_doubt = True
            raise
        for event in events:
            self.mission.apply(event)
        self._news.set()
        self._news = asyncio.Event()


@dataclass(frozen=True)
class Decided:
    """A proposal and the orders that come of it."""

    proposal: Proposal
    orders: Mapping[str, dispatch.Order]


@dataclass(frozen=True)
class Deliberation:
    """What runs away from the event loop: the strategy, then the paths of its orders."""

    strategy: Strategy
    memory: Memory

    def __call__(self, snapshot: Situation) -> Decided:
        proposal = self.strategy.propose(snapshot, self.memory)
        return Decided(proposal, dispatch.orders(proposal, snapshot, self.memory))


LEAST_TIME_LIMIT_S = 0.05
"""Below this a replan finds too little to be worth its formulation."""


def within_load(planning: PlanningMessage, load: float) -> PlanningMessage:
    """The effort of a replan when others wait for theirs: the time is shared.

    A mission with a node limit is to be repeatable and keeps its effort.
    """
    if planning.node_limit is not None or load < 1.0:
        return planning
    shared_s = max(LEAST_TIME_LIMIT_S, planning.time_limit_s / (1.0 + load))
    return planning.model_copy(update={"time_limit_s": min(planning.time_limit_s, shared_s)})


def _unchanged(mission: Mission, commands: Sequence[Command]) -> bool:
    return {command.robot: command.id for command in commands} == {
        robot: command.id for robot, command in mission.commands.items()
    }


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
