"""By how much a team is behind the plan in force."""

from collections.abc import Sequence
from math import inf

import planner
from domains.formulation import Assignment, Order, OrderKind
from domains.mission_state import Activity
from service.coordination.plan_progress import Remainder
from service.coordination.strategy import Situation
from service.coordination.travel import Travel

AT_WORK = (Activity.CLEARING, Activity.DOCKING, Activity.UNDOCKING)
DRIVES = (OrderKind.MOVE, OrderKind.EXPLORE)
MEETS = (OrderKind.DOCK, OrderKind.UNDOCK)


def behind_s(
    left: Remainder, assignments: Sequence[Assignment], situation: Situation, travel: Travel
) -> float:
    """Time that the team has lost [s]; infinite if the plan can no longer be carried out.

    A robot on its way is late by the time it still needs; whatever has not begun is late since it
    should have.

    Args:
        left: what is left of the plan.
        assignments: what the robots do next by it.
    """
    state = situation.state
    busy_until_s = {
        robot.id: robot.free_at_s - state.time_s
        for robot in state.robots
        if robot.activity in AT_WORK
    }
    driving = {
        assignment.robot: assignment.location
        for assignment in assignments
        if assignment.kind in DRIVES
    }
    if not busy_until_s and not any(a.kind is not OrderKind.WAIT for a in assignments):
        return inf
    lag_s = 0.0
    for step, orders in left.orders:
        robot, location = orders[0].robot, orders[0].location
        if orders[0].kind in MEETS and location not in travel.names:
            return inf
        if robot in busy_until_s:
            lag_s = max(lag_s, busy_until_s.pop(robot) - step.end)
        elif driving.get(robot) == location:
            del driving[robot]
            if location not in travel.names:
                return inf
            lag_s = max(lag_s, travel.times_s([robot], [location])[0][0] - step.end)
        else:
            lag_s = max(lag_s, -step.start, _detour_s(travel, left, step, orders[0]))
    return lag_s


def _detour_s(travel: Travel, left: Remainder, step: planner.Step, order: Order) -> float:
    """By how much a later movement takes longer than planned, because of a new blockade [s]."""
    if order.kind not in DRIVES:
        return 0.0
    start = left.names.id(step.arguments[1])
    if start not in travel.names or order.location not in travel.names:
        return 0.0  # it starts where somebody has been: its robot is there, or on its way
    (time_s,) = travel.times_between_s(order.robot, [start], order.location)
    return time_s - (step.duration or 0.0)
