"""Range finders: what a robot's laser sees of walls, blockades and other robots."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator._core import Floor
from simulator.fleet_scenario import HiddenBlockade, Point
from simulator.robot import Robot
from simulator.segment_geometry import nearest_on_segment


@dataclass(frozen=True, slots=True)
class Scan:
    """One sweep of a laser range finder, from the robot's pose at that time."""

    robot: str
    time_s: float
    pose: tuple[float, float, float]
    """in the map frame, as the robot believes"""
    range_m: float
    """the sensor's range: beams that met nothing show it"""
    ranges_m: NDArray[np.float32]
    """(beams,) counter-clockwise over the full circle, the first one ahead"""
    blockades: tuple[str, ...]
    """those that some beam met, or that the bumper touches"""


@dataclass(frozen=True, slots=True)
class RangeFinder:
    """Casts the beams of all robots against the same ground truth."""

    floor: Floor
    """the walls, for every robot the same"""
    noise_m: float = 0.0
    """standard deviation of a range"""

    def scan(
        self,
        robot: Robot,
        others: Sequence[Robot],
        blockades: Sequence[HiddenBlockade],
        time_s: float,
        random: np.random.Generator,
    ) -> Scan:
        """One sweep; `others` have bodies in the building."""
        kind = robot.kind
        reach = kind.sensor_range_m
        x, y, heading_rad = robot.truth
        near = [b for b in blockades if _distance((x, y), b) <= reach]
        discs = _discs_near(robot, others, (x, y), reach + 1.0)
        ranges_m, met = self.floor.scan(
            x,
            y,
            heading_rad,
            reach,
            kind.beams,
            [(*b.segment_m[0], *b.segment_m[1]) for b in near],
            discs,
        )
        seen = {near[index].id for index in met}
        # A bumper: what stands directly before the body is felt even between two beams.
        seen |= {b.id for b in near if _distance((x, y), b) < kind.radius_m + 0.1}
        if self.noise_m > 0.0:
            hit = ranges_m < reach
            noisy = ranges_m + random.normal(0.0, self.noise_m, len(ranges_m)).astype(np.float32)
            ranges_m = np.where(hit, np.clip(noisy, 0.0, reach), ranges_m).astype(np.float32)
        return Scan(
            robot.id, time_s, robot.pose, reach, ranges_m, tuple(b.id for b in near if b.id in seen)
        )


def _discs_near(
    robot: Robot, others: Sequence[Robot], at: Point, within_m: float
) -> list[tuple[float, float, float]]:
    """The bodies of others as x, y, radius, of those that are near."""
    x, y = at
    discs = []
    for other in others:
        body = other.body
        if body is None:
            far_x, far_y = other.x - x, other.y - y
        else:
            far_x, far_y = body[0] - x, body[1] - y
        # Compared along the axes first: most of a large fleet is far away.
        if -within_m <= far_x <= within_m and -within_m <= far_y <= within_m:
            place = other.truth[:2]
            if other is not robot and math.dist(place, at) <= within_m:
                discs.append((*place, other.kind.radius_m))
    return discs


def _distance(position: Point, blockade: HiddenBlockade) -> float:
    return math.dist(position, nearest_on_segment(position, blockade.segment_m))
