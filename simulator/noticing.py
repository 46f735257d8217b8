"""What a robot sees for itself that others out of contact did or suffered."""

from __future__ import annotations

import math
from collections.abc import Iterable

from simulator._core import Floor
from simulator.fleet_scenario import Point
from simulator.knowledge import Knowledge
from simulator.robot import Robot
from simulator.world import World

_SIGHT_M = 1e-6
"""half the width of a line of sight: it ends at walls, and passes beside them"""


def notice(
    robot: Robot, known: Knowledge, robots: Iterable[Robot], world: World, walls: Floor
) -> bool:
    """Learns of blockades that are gone and of robots that have died, where they are in sight.

    Returns:
        Whether a blockade is gone, so that there may be new ways.
    """
    standing = {blockade.id for blockade in world.blockades()}
    gone = [
        blockade.id
        for blockade in known.navigation.known.values()
        if blockade.id not in standing and _sees(robot, _middle(blockade.segment_m), walls)
    ]
    for blockade in gone:
        known.see_gone(blockade)
    for other in robots:
        dead = other.has_failed and not other.is_aboard and other.id not in known.dead
        if dead and _sees(robot, other.truth[:2], walls):
            known.see_dead(other.id, (other.x, other.y, other.kind.radius_m))
    return bool(gone)


def _sees(robot: Robot, place: Point, walls: Floor) -> bool:
    here = robot.truth[:2]
    return math.dist(here, place) <= robot.kind.sensor_range_m and walls.leg_is_clear(
        *here, *place, _SIGHT_M
    )


def _middle(segment: tuple[Point, Point]) -> Point:
    (ax, ay), (bx, by) = segment
    return ((ax + bx) / 2, (ay + by) / 2)
