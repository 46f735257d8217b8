"""A mission as the fold of its events.

`apply` is the only place that changes a mission. The same events in the same order give the same
mission, before and after a crash.
"""

from collections.abc import Iterable

from service.coordination.effects.frontiers import apply_frontiers
from service.coordination.effects.orders import apply_orders, give_up, plan_failed
from service.coordination.effects.people import apply_change
from service.coordination.effects.reports import apply_report
from service.coordination.events import (
    CommandGivenUp,
    Event,
    FrontiersFound,
    MissionClosed,
    MissionCreated,
    OrdersIssued,
    PlanKept,
    PlanningFailed,
    ReportAccepted,
    RobotLost,
)
from service.coordination.fleet_robot import fleet_robot
from service.coordination.known_map import grid_map
from service.coordination.mission import Mission, MissionTarget
from service.coordination.mission_map import MissionMap


def created(event: MissionCreated) -> Mission:
    """The mission as it begins."""
    request = event.request
    return Mission(
        id=event.id,
        request=request,
        robots={robot.id: fleet_robot(robot, 0.0) for robot in request.robots},
        targets={t.id: MissionTarget(t.id, t.position_m) for t in request.targets},
        map=MissionMap(grid_map(request.map, request.map.width * request.map.height)),
        domain_text=event.domain_text,
        resources=tuple(event.resources),
        events=1,
    )


def apply(mission: Mission, event: Event) -> None:
    """Brings the mission to the state after `event`.

    Raises:
        ValueError: the event cannot happen to this mission any more.
    """
    mission.events += 1
    match event:
        case ReportAccepted(report=report):
            apply_report(mission, report)
        case OrdersIssued():
            apply_orders(mission, event)
        case FrontiersFound():
            apply_frontiers(mission, event)
        case PlanKept():
            mission.plannings += 1
            mission.remark(event.remarks)
            mission.decide(event.time_s, "plan kept", event.reason)
            mission.recover()
        case PlanningFailed():
            plan_failed(mission, event)
        case CommandGivenUp():
            give_up(mission, event)
        case RobotLost():
            mission.robots[event.robot].lost = True
            mission.disturb()
            mission.drop_command(event.robot)
            mission.decide(event.time_s, "robot lost", f"{event.robot} fell silent")
        case MissionClosed():
            _close(mission, event)
        case MissionCreated():
            raise ValueError(f"mission {mission.id} was created before")
        case _:
            apply_change(mission, event)


def _close(mission: Mission, event: MissionClosed) -> None:
    if mission.is_over:
        raise ValueError(f"mission {mission.id} has ended before, as {mission.status}")
    mission.status, mission.status_reason = event.status, event.reason
    mission.commands.clear()
    mission.decide(event.time_s, event.status, event.reason)


def rebuilt(events: Iterable[Event]) -> Mission:
    """The mission that these events add up to.

    Raises:
        ValueError: they do not begin with the mission's creation.
    """
    stream = iter(events)
    first = next(stream, None)
    if not isinstance(first, MissionCreated):
        raise ValueError("a mission's events begin with its creation")
    mission = created(first)
    for event in stream:
        apply(mission, event)
    return mission
