"""One action a robot, for marsupial teams: the baseline of thesis 3.6.3, in two readings.

Carriers are assigned to targets, with the Hungarian method or another rule, as if they could drive
everywhere. A carrier whose target only a rover can reach goes to the nearest meeting point
connected to it and puts a rover down; without a rover aboard it first fetches one that has nothing
left to do. A rover on the ground explores the targets it can reach and then returns to the nearest
meeting point.

In the literal reading carriers are assigned to every target, also to those that a rover on the
ground is exploring. In the strong one such targets are the rover's own and carriers leave them
alone. In both any rover without work may be fetched by any carrier.

An assignment anew at every event can send two carriers to and fro for ever: each time that one gets
to a rover it is to fetch, the other's target suits it better, and they change places. Once orders
have changed so for long, and nothing came of it, carriers keep their targets until they are there.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite

from domains.formulation import Assignment, OrderKind
from domains.mission_state import Activity, RobotState
from semantic_attachments.contract import Memory
from service.coordination.assignment import AssignmentRule, by_hungarian_method
from service.coordination.one_step_disaster import remarks_on, steps_of
from service.coordination.pick_up import pick_up_points
from service.coordination.strategy import NoPlanError, Proposal, Situation
from service.coordination.travel import Travel, as_if_everywhere
from service.coordination.urgency import assigned_by_urgency

RESTLESS_FROM = 12
"""Decisions that changed orders without news in between; from then on carriers keep targets."""


@dataclass(frozen=True)
class OneStepMarsupial:
    """One action a robot, computed anew at every event."""

    rule: AssignmentRule = by_hungarian_method
    leaves_to_rovers: bool = True
    """the strong reading"""

    def propose(self, situation: Situation, memory: Memory) -> Proposal:
        """Rovers on the ground first, then carriers."""
        team = _Team(situation, memory, self)
        orders = team.rovers_explore()
        orders += team.carriers_explore_or_deploy()
        orders += team.idle_rovers_return({order.robot for order in orders})
        at_work = (Activity.CLEARING, Activity.DOCKING, Activity.UNDOCKING)
        if not orders and not any(robot.activity in at_work for robot in situation.state.robots):
            raise NoPlanError("no robot can reach a target or a meeting point")
        return Proposal(
            assignments=tuple(orders),
            reason=f"an assignment of {len(orders)} robots",
            steps=steps_of(orders, situation),
            # Who cannot reach a target now may be carried there.
            remarks=remarks_on(orders, situation, team.travel, ()),
        )


class _Team:
    """One situation, looked at from the team's side."""

    def __init__(self, situation: Situation, memory: Memory, baseline: OneStepMarsupial) -> None:
        state = situation.state
        self.baseline = baseline
        self.situation = situation
        self.travel = Travel.of(situation, memory)
        self.pick_up = pick_up_points(situation, self.travel)
        self.targets = [target.id for target in state.targets]
        self.meetings = [meeting.id for meeting in state.meeting_points]
        self.carriers = [
            robot
            for robot in state.robots
            if situation.models[robot.type].capacity > 0 and robot.activity is Activity.FREE
        ]
        self.rovers = [
            robot for robot in state.robots if situation.models[robot.type].capacity == 0
        ]
        self.on_ground = [robot for robot in self.rovers if robot.activity is Activity.FREE]
        self.aboard: dict[str, list[str]] = {}
        for rover in self.rovers:
            if rover.activity is Activity.DOCKED and rover.partner is not None:
                self.aboard.setdefault(rover.partner, []).append(rover.id)
        self.anywhere = as_if_everywhere(situation)

    def rovers_explore(self) -> list[Assignment]:
        """Rovers on the ground to the targets they can reach."""
        ids = [rover.id for rover in self.on_ground]
        times_s = self.travel.times_s(ids, self.targets)
        self.rover_owned = {
            target
            for column, target in enumerate(self.targets)
            if any(isfinite(row[column]) for row in times_s)
        }
        return [
            Assignment(
                ids[row],
                OrderKind.EXPLORE,
                self.targets[column],
                expected_duration_s=times_s[row][column],
            )
            for row, column in assigned_by_urgency(
                self.baseline.rule, self.situation, self.travel, ids, self.targets
            ).items()
        ]

    def carriers_explore_or_deploy(self) -> list[Assignment]:
        """Carriers to targets as if they could drive everywhere; where they cannot, a rover."""
        targets = [
            target
            for target in self.targets
            if not (self.baseline.leaves_to_rovers and target in self.rover_owned)
        ]
        chosen = self._chosen_by_carriers(targets)
        orders: list[Assignment] = []
        self.idle = {
            rover.id: rover
            for rover in self.on_ground
            if not any(isfinite(t) for t in self.travel.times_s([rover.id], self.targets)[0])
        }
        for carrier in self.carriers:
            target = chosen.get(carrier.id)
            if target is not None:
                time_s = self.travel.times_s([carrier.id], [target])[0][0]
                if isfinite(time_s):
                    orders.append(
                        Assignment(
                            carrier.id, OrderKind.EXPLORE, target, expected_duration_s=time_s
                        )
                    )
                    continue
                if self.aboard.get(carrier.id):
                    orders += self._deploy(carrier, target)
                    continue
            if self.idle and (target is not None or not targets):
                orders += self._fetch(carrier)
        return orders

    def _chosen_by_carriers(self, targets: Sequence[str]) -> dict[str, str]:
        """The target of each carrier that gets one."""
        kept: dict[str, str] = {}
        if self.situation.restless >= RESTLESS_FROM:
            going = self.situation.going
            kept = {c.id: going[c.id] for c in self.carriers if going.get(c.id) in targets}
        ids = [carrier.id for carrier in self.carriers if carrier.id not in kept]
        left = [target for target in targets if target not in kept.values()]
        found = assigned_by_urgency(self.baseline.rule, self.situation, self.anywhere, ids, left)
        return kept | {ids[row]: left[column] for row, column in found.items()}

    def _deploy(self, carrier: RobotState, target: str) -> list[Assignment]:
        """To the nearest meeting point connected to the target; there the rover gets off."""
        rover = self.aboard[carrier.id][0]
        onward_s = self.travel.times_between_s(rover, self.meetings, target)
        there_s = self.travel.times_s([carrier.id], self.meetings)[0]
        usable = [
            (time_s, meeting)
            for time_s, onward, meeting in zip(there_s, onward_s, self.meetings, strict=True)
            if isfinite(time_s) and isfinite(onward)
        ]
        if not usable:
            return []
        if carrier.arrived_at in [meeting for _, meeting in usable]:
            return self._both(OrderKind.UNDOCK, rover, carrier, carrier.arrived_at)
        time_s, meeting = min(usable)
        return [Assignment(carrier.id, OrderKind.MOVE, meeting, expected_duration_s=time_s)]

    def _fetch(self, carrier: RobotState) -> list[Assignment]:
        """To the idle rover that waits, or will wait, at the nearest meeting point."""
        best: tuple[float, str, str] = (inf, "", "")
        for rover in self.idle.values():
            meeting, _ = self._nearest_meeting(rover)
            if meeting is not None:
                time_s = self.travel.times_s([carrier.id], [meeting])[0][0]
                best = min(best, (time_s, rover.id, meeting))
        time_s, rover_id, meeting = best
        if not isfinite(time_s):
            return []
        rover = self.idle.pop(rover_id)
        if carrier.arrived_at == meeting:
            if rover.arrived_at == meeting:
                return self._both(OrderKind.DOCK, rover_id, carrier, meeting)
            return []
        return [Assignment(carrier.id, OrderKind.MOVE, meeting, expected_duration_s=time_s)]

    def idle_rovers_return(self, busy: set[str]) -> list[Assignment]:
        """Rovers that have explored all they can reach return to the nearest meeting point."""
        orders = []
        for rover in self.on_ground:
            meeting, time_s = self._nearest_meeting(rover)
            if rover.id in busy or meeting is None or rover.arrived_at == meeting:
                continue
            orders.append(Assignment(rover.id, OrderKind.MOVE, meeting, expected_duration_s=time_s))
        return orders

    def _nearest_meeting(self, rover: RobotState) -> tuple[str | None, float]:
        if rover.arrived_at in self.pick_up:
            return rover.arrived_at, 0.0
        times_s = self.travel.times_s([rover.id], self.pick_up)[0]
        time_s, meeting = min(zip(times_s, self.pick_up, strict=True), default=(inf, None))
        return (meeting, time_s) if isfinite(time_s) else (None, inf)

    def _both(
        self, kind: OrderKind, rover: str, carrier: RobotState, meeting: str | None
    ) -> list[Assignment]:
        model = self.situation.models[_type_of(self.rovers, rover)]
        duration_s = model.dock_duration_s if kind is OrderKind.DOCK else model.undock_duration_s
        return [
            Assignment(rover, kind, meeting, carrier.id, duration_s),
            Assignment(carrier.id, kind, meeting, rover, duration_s),
        ]


def _type_of(robots: Sequence[RobotState], identifier: str) -> str:
    return next(robot.type for robot in robots if robot.id == identifier)
