"""The exploration targets of a mission: found again whenever its map has grown."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from domains.mission_state import MeetingPoint
from semantic_attachments.world import OCCUPIED_FROM, Blockade, GridMap, RobotModel
from service.coordination.exploration.targets import exploration_targets, named, unknown_beside
from service.coordination.mission import Mission
from service.messages.mission import TargetMessage

SAME_TARGET_M = 3.0
"""A frontier this near to one of before carries on its name."""
SEEN_AROUND_M = 1.5
"""What a robot at a frontier has not seen of the unknown cells this near cannot be seen."""
FAILURES_TOLERATED = 3
"""A frontier that robots could not get to so often is given up."""
PREFIX = "frontier:"


@dataclass(frozen=True)
class Frontiers:
    """What is left to explore."""

    targets: tuple[TargetMessage, ...]
    """All of them, those of before that are still there with their old names."""
    changed: bool
    """Whether they differ from those the mission knows."""


def has_begun(mission: Mission) -> bool:
    """Whether the map shows anything of where the robots are; before, nothing can be said."""
    grid = mission.map.grid
    cells = [cell for cells in _robot_cells(mission, grid).values() for cell in cells]
    return any(0 <= grid.cells.flat[cell] < OCCUPIED_FROM for cell in cells)


def find_frontiers(
    mission: Mission,
    models: Mapping[str, RobotModel],
    meeting_points: Sequence[MeetingPoint],
) -> Frontiers:
    """The frontiers that robots can get to from where they are, or from where they can be put
    down."""
    grid = mission.map.grid
    blockades = tuple(
        Blockade(blockade.id, blockade.segment_m, blockade.clear_duration_s)
        for blockade in mission.blockades.values()
        if blockade.cleared_by is None
    )
    robot_cells = _robot_cells(mission, grid)
    meetings = [c for point in meeting_points if (c := grid.cell_at(point.position_m)) is not None]
    for name, model in models.items():
        if model.capacity == 0 and robot_cells.get(name) is not None:
            robot_cells[name] = [*robot_cells[name], *meetings]
    explorers = {name: model for name, model in models.items() if name != "clearer"}
    found = exploration_targets(
        grid, explorers, robot_cells, blockades=blockades, given_up=given_up(mission, grid)
    )
    known = {
        target.id: target.position_m
        for target in mission.targets.values()
        if target.is_frontier and target.is_open
    }
    names = named(
        found,
        grid,
        known,
        next_number=mission.frontiers_named + 1,
        same_within_m=SAME_TARGET_M,
        prefix=PREFIX,
    )
    positions_m = grid.centres_m([target.cell for target in names.values()]).tolist()
    targets = tuple(
        TargetMessage(id=name, position_m=(x, y))
        for name, (x, y) in sorted(zip(names, positions_m, strict=True))
    )
    return Frontiers(targets, {target.id: target.position_m for target in targets} != known)


def given_up(mission: Mission, grid: GridMap) -> NDArray[np.bool_]:
    """(height, width) unknown cells that robots went to see and did not, or could not get to."""
    failures: dict[str, int] = {}
    for (_, place), of in mission.failures.items():
        failures[place] = failures.get(place, 0) + of.count
    places_m = [
        target.visited_from_m or target.position_m
        for target in mission.targets.values()
        if target.is_frontier
        and (target.visited_by is not None or failures.get(target.id, 0) >= FAILURES_TOLERATED)
    ]
    mask = np.zeros(grid.cells.shape, dtype=np.bool_)
    reach_cells = round(SEEN_AROUND_M / grid.resolution_m)
    for place_m in places_m:
        cell = grid.cell_at(place_m)
        if cell is not None:
            mask.ravel()[unknown_beside(grid, cell, reach_cells)] = True
    return mask


def _robot_cells(mission: Mission, grid: GridMap) -> dict[str, list[int]]:
    """Cells of the robots of each type that take part; none for those that ride on others."""
    cells: dict[str, list[int]] = {}
    for robot in mission.robots.values():
        if robot.takes_part:
            of_type = cells.setdefault(robot.type, [])
            cell = grid.cell_at(robot.position_m)
            if robot.carrier is None and cell is not None:
                of_type.append(cell)
    return cells
