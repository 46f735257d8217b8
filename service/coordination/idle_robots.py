"""What robots do that the plan does not need: what will probably be needed next."""

from collections.abc import Sequence
from math import isfinite

from domains.formulation import Assignment, OrderKind
from domains.mission_state import Activity
from semantic_attachments.contract import Memory
from service.coordination.one_step_disaster import being_cleared, clear_nearest, free
from service.coordination.pick_up import pick_up_points
from service.coordination.strategy import Situation
from service.coordination.travel import Travel


def with_idle_robots(
    assignments: Sequence[Assignment], situation: Situation, memory: Memory
) -> list[Assignment]:
    """A plan's assignments, and one for robots that it does not need."""
    busy = {assignment.robot for assignment in assignments}
    ordered = _with_clearers(assignments, busy, situation, memory)
    if situation.explores_with_carriers:
        ordered += _rovers(busy, situation, memory)
    return ordered


def _with_clearers(
    assignments: Sequence[Assignment], busy: set[str], situation: Situation, memory: Memory
) -> list[Assignment]:
    """A clearer without work takes the nearest blockade nobody has taken."""
    idle = [robot for robot in free(situation, "clearer") if robot not in busy]
    blockades = {blockade.id for blockade in situation.state.blockades}
    taken = being_cleared(situation) | {
        assignment.location
        for assignment in assignments
        if assignment.location in blockades and assignment.location is not None
    }
    if not idle or taken >= blockades:
        return list(assignments)
    travel = Travel.of(situation, memory)
    return [*assignments, *clear_nearest(situation, travel, idle, taken)]


def _rovers(busy: set[str], situation: Situation, memory: Memory) -> list[Assignment]:
    """A rover without work goes where it can be fetched: to the nearest meeting point."""
    travel = Travel.of(situation, memory)
    meetings = pick_up_points(situation, travel)
    idle = [
        robot
        for robot in situation.state.robots
        if robot.id not in busy
        and robot.activity is Activity.FREE
        and situation.models[robot.type].capacity == 0
        and robot.arrived_at not in meetings
    ]
    if not (meetings and idle):
        return []
    orders = []
    for robot, times_s in zip(
        idle, travel.times_s([robot.id for robot in idle], meetings), strict=True
    ):
        time_s, meeting = min(zip(times_s, meetings, strict=True))
        if isfinite(time_s):
            orders.append(Assignment(robot.id, OrderKind.MOVE, meeting, expected_duration_s=time_s))
    return orders
