"""The mission as a strategy sees it: a frozen snapshot."""

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

from domains.mission_state import (
    Activity,
    BlockadeState,
    MeetingPoint,
    MissionState,
    RobotState,
    Target,
)
from semantic_attachments.world import RobotModel
from service.coordination.exploration.expected_area import expected_area_m2
from service.coordination.facts import MAP_CHANGED
from service.coordination.fleet_robot import FleetRobot
from service.coordination.mission import Mission, MissionTarget
from service.coordination.strategy import Situation
from service.messages.instruction import Deadline, Forbid, Pin, Priority

Order = TypeVar("Order", Priority, Deadline)
T = TypeVar("T")

FAILURES_TOLERATED = 3
"""A robot that gave up a place this often is not sent there again."""

_BUSY = {
    "clearing": Activity.CLEARING,
    "docking": Activity.DOCKING,
    "undocking": Activity.UNDOCKING,
}


def mission_state(mission: Mission, meeting_points: tuple[MeetingPoint, ...] = ()) -> MissionState:
    """What the domain's formulation needs; robots start from where they are now."""
    targets = [target for target in mission.targets.values() if target.is_open]
    unknown_m2 = _unknown_m2(mission, [target for target in targets if target.is_frontier])
    return MissionState(
        time_s=mission.time_s,
        robots=tuple(_robot_state(mission, robot) for robot in mission.robots.values()),
        targets=tuple(
            Target(target.id, target.position_m, unknown_m2.get(target.id, 0.0))
            for target in targets
        ),
        blockades=tuple(
            BlockadeState(blockade.id, blockade.segment_m, blockade.clear_duration_s)
            for blockade in mission.blockades.values()
            if blockade.cleared_by is None
        ),
        meeting_points=meeting_points,
        capacities={
            robot.id: mission.request.robot_types[robot.type].capacity
            for robot in mission.robots.values()
            if mission.request.robot_types[robot.type].capacity > 0
        },
    )


def _unknown_m2(mission: Mission, frontiers: Sequence[MissionTarget]) -> dict[str, float]:
    """What is expected to be seen from each frontier, by the types of robots that get there."""
    grid = mission.map.grid
    types = [kind for name, kind in mission.request.robot_types.items() if name != "clearer"]
    everywhere_m = min((kind.sensor_range_m for kind in types), default=0.0)
    ranges_m = []
    for frontier in frontiers:
        terrain = grid.terrain_class_at(frontier.position_m)
        able_m = [kind.sensor_range_m for kind in types if terrain in kind.enters]
        ranges_m.append(min(able_m, default=everywhere_m))
    areas_m2 = expected_area_m2(grid, [frontier.position_m for frontier in frontiers], ranges_m)
    return dict(zip((frontier.id for frontier in frontiers), areas_m2, strict=True))


def _robot_state(mission: Mission, robot: FleetRobot) -> RobotState:
    activity, partner, free_at_s = _activity(mission, robot)
    return RobotState(
        id=robot.id,
        type=robot.type,
        position_m=robot.position_m,
        activity=activity,
        partner=partner,
        arrived_at=robot.arrived_at,
        free_at_s=free_at_s,
    )


def _activity(mission: Mission, robot: FleetRobot) -> tuple[Activity, str | None, float]:
    """Activity, partner and the time it ends [s]."""
    if not robot.takes_part:
        return Activity.FAILED, None, 0.0
    busy = _BUSY.get(robot.state)
    order = mission.orders.get(robot.command or "")
    if busy is not None and order is not None:
        partner = order.location if busy is Activity.CLEARING else order.partner
        if robot.busy_until_s is not None:
            return busy, partner, robot.busy_until_s
        begun_s = mission.issued_at_s.get(order.id, mission.time_s)
        return busy, partner, begun_s + (order.expected_duration_s or 0.0)
    if robot.carrier is not None:
        return Activity.DOCKED, robot.carrier, 0.0
    return Activity.FREE, None, 0.0


def situation(
    mission: Mission,
    models: Mapping[str, RobotModel],
    meeting_points: tuple[MeetingPoint, ...],
    trigger: str,
) -> Situation:
    """The snapshot that a decision is made on."""
    return Situation(
        domain=mission.request.domain,
        domain_text=mission.domain_text,
        state=mission_state(mission, meeting_points),
        grid=mission.map.grid,
        version=mission.map.version,
        models=models,
        planning=mission.request.planning,
        trigger=trigger,
        in_force=mission.plan.steps
        if mission.plan is not None and mission.plan.validated and not mission.plan_disturbed
        else (),
        done=tuple(mission.done),
        avoid=avoided(mission),
        priorities=_by_target(mission, Priority, lambda order: order.priority),
        deadlines_s=_by_target(mission, Deadline, lambda order: order.time_s),
        exploring=mission.request.exploration is not None,
        only_map_changed=all(fact.startswith(MAP_CHANGED) for fact in trigger.split("; ")),
        going={
            robot: command.location
            for robot, command in mission.commands.items()
            if command.kind in ("move", "explore") and command.location is not None
        },
        restless=mission.restless,
        target_places_m=dict(mission.target_places_m),
        communication_range_m=None
        if mission.request.exploration is None
        else mission.request.exploration.communication_range_m,
        commands_ahead=mission.request.commands_ahead,
        instructions=tuple(
            (given.id, given.instruction) for given in mission.instructions.values()
        ),
    )


def avoided(mission: Mission) -> frozenset[tuple[str, str]]:
    """Robots and places that do not go together: by experience, and by a person's word."""
    pairs = {pair for pair, of in mission.failures.items() if of.count >= FAILURES_TOLERATED}
    for given in mission.instructions.values():
        match given.instruction:
            case Forbid(robot=robot, location=location):
                pairs.add((robot, location))
            case Pin(robot=robot, location=location):
                pairs |= {(other, location) for other in mission.robots if other != robot}
    return frozenset(pairs)


def outdated_failures(mission: Mission) -> list[tuple[str, str]]:
    """Robots and places avoided by experience with a world that is another one by now."""
    return [
        pair
        for pair, of in mission.failures.items()
        if of.count >= FAILURES_TOLERATED and of.news < mission.news
    ]


def _by_target(mission: Mission, kind: type[Order], value: Callable[[Order], T]) -> dict[str, T]:
    """What the instructions of a kind say of each target that is open; the latest counts."""
    return {
        given.instruction.target: value(given.instruction)
        for given in mission.instructions.values()
        if isinstance(given.instruction, kind) and mission.targets[given.instruction.target].is_open
    }
