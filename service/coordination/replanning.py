"""Facts in, decisions out: when a mission is planned again, and what comes of a proposal.

Planning runs elsewhere on a frozen snapshot while reports go on; what has become pointless in the
meantime is left out when the proposal is turned into commands. Facts that come together, or while a
decision is made, share the next one: there is never more than one under way.
"""

import asyncio
import logging
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

from opentelemetry import trace
from opentelemetry.context import Context

from semantic_attachments.world import RobotModel
from service.coordination import dispatch
from service.coordination.deliberation import Decided, Deliberation, shared
from service.coordination.events import FrontiersFound, OrdersIssued, PlanKept, PlanningFailed
from service.coordination.exploration.mission_frontiers import find_frontiers, has_begun
from service.coordination.ledger import Ledger
from service.coordination.meeting_points import meeting_points
from service.coordination.mission import Mission
from service.coordination.ports import Observer, Planners, PlannersLostError, StoreError
from service.coordination.remarks import remarks_without_plan
from service.coordination.situation import situation
from service.coordination.strategy import NoPlanError, Situation, Strategy
from service.messages.report import Command
from service.tracing import tell_past, traceparent

LOG = logging.getLogger(__name__)


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


@dataclass(frozen=True, slots=True)
class Cause:
    """The span in which a fact was noticed, and when."""

    span: trace.SpanContext
    at_ns: int


class Replanning:
    """Makes the decisions of one mission."""

    def __init__(
        self,
        ledger: Ledger,
        *,
        models: Mapping[str, RobotModel],
        strategy: Strategy,
        planners: Planners,
        parameters: LoopParameters,
        observer: Observer,
    ) -> None:
        self.looked_at_s = 0.0
        """Mission time of the latest snapshot."""
        self._ledger = ledger
        self._models = models
        self._meeting_points = meeting_points(ledger.mission.map.grid, models)
        self._meetings_of = ledger.mission.map.version
        self._strategy = strategy
        self._planners = planners
        self._parameters = parameters
        self._observer = observer
        self._facts: list[str] = []
        self._facts_since_s = 0.0
        self._causes: list[Cause] = []
        self._replanning: asyncio.Task[None] | None = None
        self._fleet = _client_of(ledger.mission)
        self._quiet = asyncio.Event()
        self._quiet.set()
        self._waiters = 0

    def ask(self, found: Sequence[str]) -> None:
        """Asks for a replan because of these facts."""
        if not self._facts:
            self._facts_since_s = time.monotonic()
        self._causes.append(Cause(trace.get_current_span().get_span_context(), time.time_ns()))
        self._observer.noticed(len(found))
        self._facts += found
        self._quiet.clear()
        if self._replanning is None or self._replanning.done():
            self._replanning = asyncio.get_running_loop().create_task(self._replan_until_quiet())

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

    async def _replan_until_quiet(self) -> None:
        try:
            while self._facts and not self._ledger.mission.is_over:
                if self._waiters == 0:
                    await asyncio.sleep(self._parameters.debounce_s)
                found, self._facts = self._facts, []
                since_s = self._facts_since_s
                try:
                    outcome = await self._traced("; ".join(dict.fromkeys(found)))
                    self._observe(outcome, time.monotonic() - since_s)
                except StoreError as error:
                    LOG.error("mission %s: %s; trying again", self._ledger.mission.id, error)
                    self._facts = found + self._facts
                    await asyncio.sleep(self._parameters.retry_s)
        finally:
            self._quiet.set()

    async def _traced(self, trigger: str) -> str:
        """How a replan ended; a span of the trace that gave the first cause."""
        causes, self._causes = self._causes, []
        first, *others = causes or [Cause(trace.INVALID_SPAN_CONTEXT, time.time_ns())]
        parent = trace.set_span_in_context(trace.NonRecordingSpan(first.span), Context())
        with self._observer.tracer.start_as_current_span(
            "replan",
            context=parent,
            links=[trace.Link(cause.span) for cause in others if cause.span.is_valid],
            start_time=first.at_ns,
            attributes={"mission": self._ledger.mission.id, "trigger": trigger},
        ) as span:
            outcome = await self._replan_once(trigger)
            span.set_attribute("outcome", outcome)
        return outcome

    def _observe(self, outcome: str, duration_s: float) -> None:
        plan = self._ledger.mission.plan if outcome == "new plan" else None
        makespan_s = None if plan is None else plan.end_s - plan.adopted_at_s
        self._observer.replanned(outcome, duration_s, makespan_s)

    async def _replan_once(self, trigger: str) -> str:
        async with self._ledger.locked() as mission:
            if mission.map.version != self._meetings_of:
                self._meeting_points = await asyncio.to_thread(
                    meeting_points, mission.map.grid, self._models, self._meeting_points
                )
                self._meetings_of = mission.map.version
            if mission.request.exploration is not None and not await self._look_for_frontiers():
                return "explored"
            snapshot = situation(mission, self._models, self._meeting_points, trigger)
            events = mission.events
        self.looked_at_s = snapshot.state.time_s
        snapshot = shared(snapshot, self._planners.share_s)
        return await self._decide(snapshot, events)

    async def _look_for_frontiers(self) -> bool:
        """Brings the exploration targets up to date; false if that was the end of the mission."""
        mission = self._ledger.mission
        if not has_begun(mission):
            return True
        found = await asyncio.to_thread(find_frontiers, mission, self._models, self._meeting_points)
        if found.changed:
            await self._ledger.record(
                [FrontiersFound(time_s=mission.time_s, targets=list(found.targets))]
            )
        if mission.targets_left == 0:
            await self._ledger.close("completed", "all that robots can get to is explored")
        return not mission.is_over

    async def _decide(self, snapshot: Situation, events: int) -> str:
        """How the decision on a snapshot of that many events ended, in a word or two."""
        hopeless = False
        mission_id = self._ledger.mission.id
        try:
            decision = await self._planners.decide(
                Deliberation(mission_id, self._fleet, self._strategy, snapshot, traceparent())
            )
            tell_past(
                self._observer.tracer,
                ("strategy", decision.proposing_s),
                ("paths", decision.routing_s),
            )
        except NoPlanError as error:
            outcome: Decided | str = f"{snapshot.trigger}: {error}"
            hopeless = True
        except PlannersLostError as error:
            LOG.error("mission %s: %s", mission_id, error)
            outcome = f"{snapshot.trigger}: {error}"
        except Exception as error:
            LOG.exception("mission %s: the strategy failed", mission_id)
            outcome = f"{snapshot.trigger}: the strategy failed: {error}"
        else:
            outcome = decision
        async with self._ledger.locked() as mission:
            if mission.is_over:
                return "mission over"
            if isinstance(outcome, str):
                time_s = mission.time_s
                # What has happened in the meantime gives hope.
                hopeless = hopeless and not self._facts
                await self._ledger.record(
                    [
                        PlanningFailed(
                            time_s=time_s,
                            reason=outcome,
                            hopeless=hopeless,
                            remarks=remarks_without_plan(
                                snapshot, outcome.removeprefix(f"{snapshot.trigger}: ")
                            ),
                        )
                    ]
                )
                if hopeless and mission.hopeless_since_s is None:
                    self.ask(["robots may go again where they gave up"])
                return "no plan"
            return await self._adopt(snapshot, events, outcome)

    async def _adopt(self, snapshot: Situation, events: int, decided: Decided) -> str:
        mission, proposal = self._ledger.mission, decided.proposal
        revision = mission.revision + 1
        commands = dispatch.commands(mission, decided.orders, revision)
        reason = f"{snapshot.trigger}: {proposal.reason}"
        if proposal.keeps_plan and _unchanged(mission, commands):
            await self._ledger.record(
                [PlanKept(time_s=mission.time_s, reason=reason, remarks=dict(proposal.remarks))]
            )
            return "plan kept"
        await self._ledger.record(
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


def _client_of(mission: Mission) -> str:
    """Fleets take turns at the planners; a mission that names none is a fleet of its own."""
    fleet = mission.request.fleet
    return mission.id if fleet == "default" else fleet


def _unchanged(mission: Mission, commands: Sequence[Command]) -> bool:
    return {command.robot: command.id for command in commands} == {
        robot: command.id for robot, command in mission.commands.items()
    }
