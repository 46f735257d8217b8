"""Meeting of a carrier and a rover: where each stands, and where a rover gets off."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from simulator.fleet_client import Command
from simulator.fleet_scenario import MARGIN_M, Point
from simulator.navigation import REACH_M, Navigation
from simulator.robot import Robot


def may_dock(carrier: Robot, rover: Robot, robots: Iterable[Robot], navigation: Navigation) -> bool:
    """Whether both stand within reach of one another and there is a free place aboard."""
    aboard = sum(robot.carrier == carrier.id for robot in robots)
    if aboard >= carrier.kind.capacity or carrier.is_busy or rover.is_busy or rover.is_aboard:
        return False
    for one, other in ((carrier, rover), (rover, carrier)):
        command = one.command
        wants = command is not None and command.kind == "dock" and command.partner == other.id
        if not wants and not one.command_over:
            return False
    far = math.dist(carrier.position, rover.position)
    reach = carrier.kind.radius_m + rover.kind.radius_m + REACH_M + 0.05
    return far <= reach and _nothing_between(carrier, rover, navigation)


def _nothing_between(carrier: Robot, rover: Robot, navigation: Navigation) -> bool:
    return navigation.walls.leg_is_clear(*carrier.position, *rover.position, 0.0)


def meeting_goals(
    robot: Robot, partner: Robot, command: Command, navigation: Navigation
) -> list[Point]:
    """Where a robot goes to meet its partner: beside it if that is close by, else to the place."""
    place = command.path_m[-1] if command.path_m else None
    rides = partner.carrier == robot.id or robot.carrier == partner.id
    if rides or robot.kind.capacity:
        return [place] if place is not None else []
    if place is not None and math.dist(partner.position, place) > 1.0:
        return [place]
    return beside(robot, partner, navigation) or ([place] if place is not None else [])


def beside(robot: Robot, partner: Robot, navigation: Navigation) -> list[Point]:
    """Places from which the robot reaches its partner without touching it."""
    apart = robot.kind.radius_m + partner.kind.radius_m
    places = navigation.floor(robot.kind).approaches(
        (*partner.position, *partner.position),
        robot.kind.radius_m,
        MARGIN_M,
        partner.kind.radius_m + REACH_M,
        navigation.quads(),
    )
    return [place for place in places if math.dist(place, partner.position) >= apart + 0.1]


def place_beside(
    rover: Robot, carrier: Robot, robots: Mapping[str, Robot], navigation: Navigation
) -> Point | None:
    """A free place for a rover that gets off, the roomiest first."""
    floor = navigation.floor(rover.kind)
    standing = [r for r in robots.values() if not r.is_aboard and r is not carrier]
    best: tuple[float, Point] | None = None
    for place in beside(rover, carrier, navigation):
        gap = min(
            (math.dist(place, r.position) - r.kind.radius_m for r in standing), default=math.inf
        )
        if gap < rover.kind.radius_m + 0.1:
            continue
        room = min(gap, floor.clearance(*place, 1.0))
        if best is None or room > best[0] + 1e-9:
            best = (room, place)
    return None if best is None else best[1]
