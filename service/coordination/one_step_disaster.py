"""One action a robot, for disaster recovery: explorers to targets, clearers to blockades.

The baseline of thesis 3.6.6, with the Hungarian method, and other rules in its place. Each group is
assigned on its own. The thesis leaves open what an explorer does whose every target is sealed. In
the literal reading it stays where it is; in the strong one it drives to the blockade where the
shortest way to its nearest target would be barred, and waits there. A clearer without a blockade
waits.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite

from domains.formulation import Assignment, OrderKind
from domains.mission_state import Activity
from semantic_attachments.contract import Memory
from service.coordination.assignment import AssignmentRule, by_hungarian_method
from service.coordination.dispatch import comes_within
from service.coordination.follow_ups import clear_on_arrival
from service.coordination.remarks import remarks
from service.coordination.strategy import NoPlanError, Proposal, Situation
from service.coordination.travel import Travel
from service.coordination.urgency import assigned_by_urgency
from service.messages.plan import PlanStep

MOST_WAITING = 4
"""Explorers that wait at one blockade: more would keep the clearer from it."""


@dataclass(frozen=True)
class OneStepDisaster:
    """One action a robot, computed anew at every event."""

    rule: AssignmentRule = by_hungarian_method
    waits_at_blockades: bool = True
    """the strong reading"""

    def propose(self, situation: Situation, memory: Memory) -> Proposal:
        """Explorers to targets, then clearers to blockades, independent of each other."""
        travel = Travel.of(situation, memory)
        assignments = [
            *self._explorers(situation, travel, memory),
            *self._clearers(situation, travel),
        ]
        if not assignments and not _busy(situation):
            raise NoPlanError("no robot can reach a target or a blockade")
        return Proposal(
            assignments=tuple(assignments),
            then=clear_on_arrival(situation, assignments),
            reason=f"an assignment of {len(assignments)} robots",
            steps=steps_of(assignments, situation),
            remarks=remarks_on(assignments, situation, travel, free(situation, "explorer")),
        )

    def _explorers(self, situation: Situation, travel: Travel, memory: Memory) -> list[Assignment]:
        explorers = free(situation, "explorer")
        targets = [target.id for target in situation.state.targets]
        if not explorers or not targets:
            return []
        times_s = travel.times_s(explorers, targets)
        chosen = assigned_by_urgency(self.rule, situation, travel, explorers, targets, share=True)
        assignments = [
            Assignment(
                explorers[row],
                OrderKind.EXPLORE,
                targets[column],
                expected_duration_s=times_s[row][column],
            )
            for row, column in chosen.items()
        ]
        sealed = [robot for row, robot in enumerate(explorers) if row not in chosen]
        if self.waits_at_blockades:
            assignments += wait_at_blockades(situation, travel, sealed, targets, memory)
        return assignments

    def _clearers(self, situation: Situation, travel: Travel) -> list[Assignment]:
        clearers = free(situation, "clearer")
        taken = being_cleared(situation)
        return clear_nearest(situation, travel, clearers, taken, self.rule)


def wait_at_blockades(
    situation: Situation,
    travel: Travel,
    explorers: Sequence[str],
    targets: Sequence[str],
    memory: Memory,
) -> list[Assignment]:
    """Sends explorers to the blockade on the optimistic way to their nearest target.

    The nearest few of those that would wait at one; the others stay where they are.
    """
    blockades = situation.state.blockades
    if not explorers or not blockades or not targets:
        return []
    opened = replace(situation, state=replace(situation.state, blockades=()))
    optimistic = Travel(opened, memory)
    times_s = optimistic.times_s(explorers, targets)
    waiting: dict[str, list[tuple[float, int]]] = {}
    for row, robot in enumerate(explorers):
        nearest = min(range(len(targets)), key=times_s[row].__getitem__)
        if not isfinite(times_s[row][nearest]):
            continue
        path = optimistic.path_m(robot, targets[nearest])
        barred = [b.id for b in blockades if comes_within(path, b.segment_m, 0.0)]
        reachable = [
            (time_s, blockade)
            for blockade, time_s in zip(barred, travel.times_s([robot], barred)[0], strict=True)
            if isfinite(time_s)
        ]
        if reachable:
            time_s, blockade = min(reachable)
            waiting.setdefault(blockade, []).append((time_s, row))
    sent = {
        row: Assignment(explorers[row], OrderKind.MOVE, blockade, expected_duration_s=time_s)
        for blockade, candidates in waiting.items()
        for time_s, row in sorted(candidates)[:MOST_WAITING]
    }
    return _unless_there([sent[row] for row in sorted(sent)], situation)


def free(situation: Situation, robot_type: str) -> list[str]:
    """Ids of the robots of a type that can be given an order."""
    return [
        robot.id
        for robot in situation.state.robots
        if robot.type == robot_type and robot.activity is Activity.FREE
    ]


def being_cleared(situation: Situation) -> set[str]:
    """Blockades that a robot is at work on."""
    return {
        robot.partner
        for robot in situation.state.robots
        if robot.activity is Activity.CLEARING and robot.partner is not None
    }


def clear_nearest(
    situation: Situation,
    travel: Travel,
    clearers: Sequence[str],
    taken: set[str],
    rule: AssignmentRule = by_hungarian_method,
) -> list[Assignment]:
    """Assigns clearers to blockades nobody has taken; one that stands at its own clears it."""
    blockades = {b.id: b for b in situation.state.blockades if b.id not in taken}
    arrived = {robot.id: robot.arrived_at for robot in situation.state.robots}
    orders: dict[str, Assignment] = {}
    for robot in clearers:
        here = blockades.pop(arrived[robot] or "", None)
        if here is not None:
            orders[robot] = Assignment(
                robot, OrderKind.CLEAR, here.id, expected_duration_s=here.clear_duration_s
            )
    drivers = [robot for robot in clearers if robot not in orders]
    ids = list(blockades)
    if drivers and ids:
        times_s = travel.times_s(drivers, ids)
        for row, column in rule(travel, drivers, ids).items():
            orders[drivers[row]] = Assignment(
                drivers[row], OrderKind.MOVE, ids[column], expected_duration_s=times_s[row][column]
            )
    return [orders[robot] for robot in clearers if robot in orders]


def remarks_on(
    assignments: Sequence[Assignment], situation: Situation, travel: Travel, visitors: Sequence[str]
) -> dict[str, str]:
    """Why one-step orders do not do what people have said; `visitors` are free to be sent."""
    if not situation.instructions:
        return {}
    visits_s = {
        order.location: order.expected_duration_s
        for order in assignments
        if order.kind is OrderKind.EXPLORE and order.location is not None
    }
    targets = [target.id for target in situation.state.targets]
    times_s = travel.times_s(visitors, targets)
    unreachable = {
        target
        for column, target in enumerate(targets)
        if visitors and not any(isfinite(row[column]) for row in times_s)
    }
    return remarks(situation, visits_s, unreachable)


def steps_of(assignments: Sequence[Assignment], situation: Situation) -> tuple[PlanStep, ...]:
    """One-step assignments as the steps of a plan that begins now."""
    return tuple(
        PlanStep(
            start_s=situation.state.time_s,
            action=assignment.kind.value,
            arguments=[
                name
                for name in (assignment.robot, assignment.partner, assignment.location)
                if name is not None
            ],
            duration_s=assignment.expected_duration_s,
        )
        for assignment in assignments
    )


def _unless_there(assignments: Sequence[Assignment], situation: Situation) -> list[Assignment]:
    arrived = {robot.id: robot.arrived_at for robot in situation.state.robots}
    return [
        Assignment(order.robot, OrderKind.WAIT, order.location)
        if arrived[order.robot] == order.location
        else order
        for order in assignments
    ]


def _busy(situation: Situation) -> bool:
    busy = (Activity.CLEARING, Activity.DOCKING, Activity.UNDOCKING)
    return any(robot.activity in busy for robot in situation.state.robots)
