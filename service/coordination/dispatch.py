"""From assignments to commands: paths, durations, and ids that stay while the order stays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

from shapely import LineString

from domains.formulation import Assignment, OrderKind
from domains.mission_state import MeetingPoint, Target
from semantic_attachments.contract import Memory
from service.coordination.mission import Mission
from service.coordination.strategy import Proposal, Situation
from service.coordination.travel import Travel
from service.messages.base import Position
from service.messages.report import Command, FollowUp

_DRIVES = (OrderKind.MOVE, OrderKind.EXPLORE)
_BUSY = ("clearing", "docking", "undocking")


@dataclass(frozen=True, slots=True)
class Order:
    """What a robot shall do, not yet a command with an id."""

    assignment: Assignment
    path_m: tuple[Position, ...] = ()
    then: tuple[tuple[Assignment, Position | None], ...] = ()
    """What comes after it out of contact, and where."""


def orders(proposal: Proposal, situation: Situation, memory: Memory) -> dict[str, Order]:
    """The proposal's orders with the paths that the robots shall drive."""
    travel = Travel.of(situation, memory)
    state, most = situation.state, situation.commands_ahead
    places: tuple[Target | MeetingPoint, ...] = (*state.targets, *state.meeting_points)
    places_m = {place.id: place.position_m for place in places}
    return {
        assignment.robot: Order(
            _from_here(assignment, travel),
            travel.path_m(assignment.robot, assignment.location)
            if assignment.kind in _DRIVES and assignment.location is not None
            else (),
            tuple(
                (after, places_m.get(after.location or ""))
                for after in proposal.then.get(assignment.robot, ())[:most]
            ),
        )
        for assignment in proposal.assignments
    }


def _from_here(assignment: Assignment, travel: Travel) -> Assignment:
    """An assignment that takes at least as long as its way is now.

    A plan that goes on may have been made for a shorter one.
    """
    if assignment.kind not in _DRIVES or assignment.location is None:
        return assignment
    time_s = travel.times_s([assignment.robot], [assignment.location])[0][0]
    if not assignment.expected_duration_s < time_s < inf:
        return assignment
    return replace(assignment, expected_duration_s=time_s)


def commands(
    mission: Mission, orders_by_robot: Mapping[str, Order], revision: int
) -> list[Command]:
    """The command of every robot that takes part, as the mission stands now.

    `orders_by_robot` may come from a slightly older snapshot: what became pointless since is left
    out. A robot that cannot be interrupted keeps its command; one without an order waits.
    """
    issued = []
    for robot in mission.robots.values():
        if not robot.takes_part:
            continue
        current = mission.commands.get(robot.id)
        if robot.state in _BUSY and current is not None and current.id == robot.command:
            issued.append(current)
            continue
        order = orders_by_robot.get(robot.id)
        if order is None or _is_pointless(mission, order.assignment):
            order = Order(Assignment(robot.id, OrderKind.WAIT))
        if current is not None and _is_same(mission, current, order):
            issued.append(_followed(current, order, revision))
        else:
            issued.append(_command(order, revision))
    return issued


def _command(order: Order, revision: int) -> Command:
    assignment = order.assignment
    waits = assignment.kind is OrderKind.WAIT
    command = Command(
        id=f"r{revision}-{assignment.robot}",
        robot=assignment.robot,
        kind=assignment.kind.value,
        location=assignment.location,
        partner=assignment.partner,
        path_m=list(order.path_m),
        expected_duration_s=None if waits else assignment.expected_duration_s,
        revision=revision,
    )
    return _followed(command, order, revision)


def _followed(command: Command, order: Order, revision: int) -> Command:
    """The command with what its robot does afterwards if it is out of contact then."""
    if not order.then:
        return command
    then = [
        FollowUp(
            id=f"r{revision}-{command.robot}+{number}",
            kind=after.kind.value,
            location=after.location,
            partner=after.partner,
            position_m=position_m,
        )
        for number, (after, position_m) in enumerate(order.then, 1)
    ]
    return command.model_copy(update={"then": then})


def _is_pointless(mission: Mission, assignment: Assignment) -> bool:
    location, partner = assignment.location or "", assignment.partner or ""
    match assignment.kind:
        case OrderKind.MOVE:
            # It arrived while the order was being thought out: nobody drives there twice.
            return mission.robots[assignment.robot].arrived_at == location
        case OrderKind.EXPLORE:
            return location not in mission.targets or not mission.targets[location].is_open
        case OrderKind.CLEAR:
            return mission.blockades[location].cleared_by is not None
        case OrderKind.DOCK:
            robot = mission.robots[assignment.robot]
            return robot.carrier == partner or mission.robots[partner].carrier == robot.id
        case OrderKind.UNDOCK:
            robot = mission.robots[assignment.robot]
            return robot.carrier != partner and mission.robots[partner].carrier != robot.id
    return False


def _is_same(mission: Mission, current: Command, order: Order) -> bool:
    """Whether a robot that executes `current` can simply go on."""
    assignment = order.assignment
    if (current.kind, current.location, current.partner) != (
        assignment.kind.value,
        assignment.location,
        assignment.partner,
    ):
        return False
    if current.id in mission.barred:
        return False
    since_s = mission.issued_at_s.get(current.id, 0.0)
    radius_m = mission.request.robot_types[mission.robots[current.robot].type].radius_m
    return not any(
        comes_within(current.path_m, blockade.segment_m, radius_m)
        for blockade in mission.blockades.values()
        if blockade.cleared_by is None
        and blockade.seen_at_s >= since_s
        and blockade.id != current.location
    )


def comes_within(
    path_m: Sequence[Position], segment_m: tuple[Position, Position], distance_m: float
) -> bool:
    """Whether a path comes as near as that to a segment."""
    return len(path_m) > 1 and LineString(path_m).dwithin(LineString(segment_m), distance_m)
