"""The run of section 2.6.2: two robots that look ahead only, in an office of 37 x 14 m."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from scenarios.exploration.arms import ARMS
from scenarios.exploration.buildings import Building, generated
from scenarios.exploration.one_run import RunParameters, explore
from simulator.kinematic_exploration import ExplorationResult, KinematicParameters

PIONEER = KinematicParameters(
    speed_m_s=0.3, sensor_range_m=8.0, field_of_view_rad=pi, measuring_s=4.0
)
"""a robot's speed in an office, a 180 degree laser, and the time to turn around at a target"""
INSIDE_M = 0.8
"""so far into a room a robot counts as having entered it"""


def two_robot_table(*, quick: bool) -> str:
    """Markdown: duration, way, and rooms entered by one robot, for several drawn offices."""
    lines = [
        "| office | strategy | duration | driven | rooms entered by one | by both | by none |",
        "|---|---|---|---|---|---|---|",
    ]
    for seed in (1,) if quick else (1, 2, 3, 4, 5):
        building = generated("small_rooms", seed)
        for arm in ("segments", "segments by hand", "nearest"):
            parameters = RunParameters(kinematics=PIONEER)
            result, _ = explore(building, 2, seed, ARMS[arm](building), parameters)
            minutes, seconds = divmod(round(result.duration_s), 60)
            driven = " + ".join(f"{way:.0f}" for way in result.driven_m.values())
            one, both, none = rooms_entered(building, result)
            lines.append(
                f"| {seed} | {arm} | {minutes}:{seconds:02d} min | {driven} m | {one} | {both} "
                f"| {none} |"
            )
    return "\n".join(lines)


def rooms_entered(building: Building, result: ExplorationResult) -> tuple[int, int, int]:
    """Numbers of rooms that one robot, more than one and no robot has entered.

    The two corridors, the first spaces of the plan, are no rooms.
    """
    if building.rooms is None:
        raise ValueError(f"{building.name} has no rooms")
    inner = _without_margin(building.rooms, round(INSIDE_M / building.truth.resolution_m))
    visits = []
    for track in result.tracks.values():
        cells = (track[:, 1:] / building.truth.resolution_m).astype(int)
        visits.append(set(inner[cells[:, 1], cells[:, 0]].tolist()))
    rooms = set(np.unique(building.rooms).tolist()) - {0, 1, 2}
    counts = [sum(room in visited for visited in visits) for room in rooms]
    return counts.count(1), sum(count > 1 for count in counts), counts.count(0)


def _without_margin(rooms: NDArray[np.int32], cells: int) -> NDArray[np.int32]:
    """The rooms without the strip along their walls and in their doors."""
    from scipy import ndimage

    size = 2 * cells + 1
    least = ndimage.minimum_filter(rooms, size, mode="constant", cval=0)
    most = ndimage.maximum_filter(rooms, size, mode="constant", cval=0)
    return np.where(least == most, rooms, np.int32(0))
