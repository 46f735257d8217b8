"""The record of a mission, and its frames, from nothing but its events."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from itertools import pairwise
from math import hypot

import numpy as np
from numpy.typing import NDArray

from scenarios.mission_record import (
    Activity,
    BlockadeRecord,
    DecisionRecord,
    MissionRecord,
    PlannedStep,
    PlanRecord,
    RobotRecord,
    TargetRecord,
)
from scenarios.replay.log import creation
from service.coordination.events import Event, OrdersIssued, ReportAccepted
from service.coordination.history import apply, created
from service.coordination.mission import Mission
from service.messages.plan import Decision

Sample = tuple[float, float, float]


@dataclass(frozen=True)
class Ground:
    """The map that a mission ended with, as a report draws it."""

    cells: NDArray[np.int8]
    resolution_m: float
    origin_m: tuple[float, float]


@dataclass
class Moment:
    """The mission after an event, and what that event brought."""

    mission: Mission
    event: Event
    decisions: list[Decision]


def moments(events: Sequence[Event]) -> Iterator[Moment]:
    """The mission, event by event; it is the same object each time."""
    mission = created(creation(events))
    last: Decision | None = None
    yield Moment(mission, events[0], [])
    for event in events[1:]:
        apply(mission, event)
        fresh: list[Decision] = []
        for decision in reversed(mission.decisions):
            if decision is last:
                break
            fresh.append(decision)
        last = mission.decisions[-1] if mission.decisions else None
        yield Moment(mission, event, fresh[::-1])


@dataclass
class _Doing:
    """What one robot has done so far."""

    trail: list[Sample] = field(default_factory=list)
    activities: list[Activity] = field(default_factory=list)
    now: tuple[str, str | None, str] | None = None
    """Kind, location and command of what it is at."""
    since_s: float = 0.0

    def turn_to(self, now: tuple[str, str | None, str] | None, time_s: float) -> None:
        """It is at something else from now on."""
        if now == self.now:
            return
        if self.now is not None and time_s > self.since_s:
            self.activities.append(Activity(self.now[0], self.now[1], self.since_s, time_s))
        self.now, self.since_s = now, time_s


def record_of(events: Sequence[Event]) -> tuple[MissionRecord, Ground]:
    """What happened in a mission, and its map."""
    doing: dict[str, _Doing] = {}
    decisions: list[Decision] = []
    plans: list[PlanRecord] = []
    mission = None
    reported = -1
    for moment in moments(events):
        mission = moment.mission
        decisions += moment.decisions
        if isinstance(moment.event, OrdersIssued) and moment.event.new_plan:
            plans.append(_plan(moment.event))
        if isinstance(moment.event, ReportAccepted) and moment.event.report.sequence > reported:
            reported = moment.event.report.sequence
            _follow(mission, moment.event, doing)
    if mission is None:
        raise ValueError("a mission has events")
    for one in doing.values():
        one.turn_to(None, mission.time_s)
    grid = mission.map.grid
    ground = Ground(grid.cells, grid.resolution_m, grid.origin_m)
    return _record(mission, doing, decisions, plans), ground


def _follow(mission: Mission, event: ReportAccepted, doing: dict[str, _Doing]) -> None:
    for report in event.report.robots:
        one = doing.setdefault(report.id, _Doing())
        one.trail.append((mission.time_s, report.pose[0], report.pose[1]))
        order = mission.orders.get(report.command or "")
        if report.state in ("failed", "docked"):
            one.turn_to((report.state, None, ""), mission.time_s)
        elif order is None or report.state == "idle":
            one.turn_to(None, mission.time_s)
        else:
            one.turn_to((order.kind, order.location, order.id), mission.time_s)


def _plan(event: OrdersIssued) -> PlanRecord:
    steps = tuple(
        PlannedStep(step.action, tuple(step.arguments), step.start_s, step.duration_s or 0.0)
        for step in event.steps
    )
    end_s = max((step.start_s + step.duration_s for step in steps), default=event.time_s)
    return PlanRecord(event.revision, event.time_s, end_s, event.validated, steps)


def _record(
    mission: Mission,
    doing: dict[str, _Doing],
    decisions: Sequence[Decision],
    plans: Sequence[PlanRecord],
) -> MissionRecord:
    request, grid = mission.request, mission.map.grid
    return MissionRecord(
        scenario=request.name,
        strategy=request.strategy,
        domain=request.domain,
        seed=request.planning.seed,
        version=version("marsupial"),
        status=mission.status,
        status_reason=mission.status_reason,
        duration_s=mission.time_s,
        wall_s=0.0,
        planning_s=0.0,
        map_size_m=(grid.width * grid.resolution_m, grid.height * grid.resolution_m),
        sealed_fraction=0.0,
        wall_collisions=0,
        robot_collisions=0,
        blockade_crossings=0,
        replans=mission.replans,
        robots=tuple(_robot(mission, name, doing.get(name, _Doing())) for name in mission.robots),
        targets=tuple(
            TargetRecord(target.id, target.position_m, target.visited_by, target.visited_at_s)
            for target in mission.targets.values()
            if not target.removed
        ),
        blockades=tuple(
            BlockadeRecord(
                blockade.id,
                blockade.segment_m,
                blockade.clear_duration_s,
                blockade.seen_at_s,
                blockade.cleared_by,
                blockade.cleared_at_s,
            )
            for blockade in mission.blockades.values()
        ),
        decisions=tuple(
            DecisionRecord(one.time_s, one.revision, one.kind, one.reason) for one in decisions
        ),
        plans=tuple(plans),
        mission=mission.id,
    )


def _robot(mission: Mission, name: str, done: _Doing) -> RobotRecord:
    robot = mission.robots[name]
    trail = tuple(done.trail) or ((0.0, robot.pose[0], robot.pose[1]),)
    pairs = pairwise(trail)
    driven_m = sum(hypot(b[1] - a[1], b[2] - a[2]) for a, b in pairs)
    return RobotRecord(name, robot.type, trail, tuple(done.activities), driven_m)
