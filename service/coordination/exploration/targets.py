"""Exploration targets of a team in a partially known map (Wurm, section 2.2)."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import dist

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.contract import Memory
from semantic_attachments.neighbours import beside
from semantic_attachments.world import OCCUPIED_FROM, Blockade, GridMap, PositionM, RobotModel
from service.coordination.exploration.reach import ReachableSpace, reachable_space
from service.coordination.frontiers import frontiers

LEAST_CELLS = 2
"""Frontiers of fewer cells are gaps between beams."""


@dataclass(frozen=True, slots=True)
class ExplorationTarget:
    """A place from which unknown space can be seen, and who can get there."""

    cell: int
    """Where a robot can stand, `row * width + column`."""
    frontier_cell: int
    """The cell of the frontier that it can see from there."""
    cells: int
    """Number of frontier cells that it stands for."""
    robot_types: tuple[str, ...]
    """The class of robots that it was found for."""


def exploration_targets(
    grid: GridMap,
    models: Mapping[str, RobotModel],
    robot_cells: Mapping[str, Collection[int]],
    *,
    blockades: tuple[Blockade, ...] = (),
    memory: Memory | None = None,
    given_up: NDArray[np.bool_] | None = None,
) -> tuple[ExplorationTarget, ...]:
    """Frontiers that some robot can reach from where it is.

    Robot types that move in the same space share their targets; a type that gets less far than
    another, for instance a carrier beside its rovers, comes first, and the others add what lies
    in the space that it cannot enter.

    Args:
        models: the robot model of each type.
        robot_cells: where the robots of each type are, or could be put down; types without any
            have no targets.
        memory: keeps the spaces for whoever goes on with the same map.
        given_up: (height, width) unknown cells that cannot be seen from where robots get to.
    """
    memory = memory or Memory()
    unknown = grid.cells < 0
    if given_up is not None:
        unknown &= ~given_up
    taken = np.zeros(grid.cells.shape, dtype=np.bool_)
    found: list[ExplorationTarget] = []
    for types in _classes(models, robot_cells):
        model = models[types[0]]
        space = reachable_space(grid, model, blockades, memory)
        cells = [cell for name in types for cell in robot_cells[name]]
        reached = _reached(space, cells)
        before = space.before(reached)
        for frontier in frontiers(
            before & ~taken,
            unknown,
            visible_cells=model.sensor_range_m / grid.resolution_m,
            least_cells=LEAST_CELLS,
        ):
            row, column = frontier.cell
            cell = row * grid.width + column
            standing = space.nearest_in(reached, cell)
            if standing is not None:
                found.append(ExplorationTarget(standing, cell, frontier.cells, tuple(types)))
        taken |= before
    return tuple(found)


def named(
    found: Sequence[ExplorationTarget],
    grid: GridMap,
    known: Mapping[str, PositionM],
    *,
    next_number: int,
    same_within_m: float,
    prefix: str = "frontier ",
) -> dict[str, ExplorationTarget]:
    """Names of targets: what lies near a target of before has its name, others get new ones.

    A frontier moves as the map grows; plans and orders that speak of it stay meaningful.

    Args:
        known: positions of the targets of before, by name.
        next_number: the number in the first new name.
    """
    positions_m = grid.centres_m([target.cell for target in found])
    names: dict[int, str] = {}
    pairs = sorted(
        (dist(position_m, positions_m[index]), name, index)
        for name, position_m in known.items()
        for index in range(len(found))
    )
    for apart_m, name, index in pairs:
        if apart_m <= same_within_m and index not in names and name not in names.values():
            names[index] = name
    for index in range(len(found)):
        if index not in names:
            names[index] = f"{prefix}{next_number}"
            next_number += 1
    return {names[index]: target for index, target in enumerate(found)}


def unknown_beside(grid: GridMap, cell: int, reach_cells: int) -> NDArray[np.int64]:
    """(n,) unknown cells next to free ones around a target: what a robot goes there to see."""
    row, column = divmod(cell, grid.width)
    top, left = max(row - reach_cells, 0), max(column - reach_cells, 0)
    window = grid.cells[top : row + reach_cells + 1, left : column + reach_cells + 1]
    rows, columns = np.nonzero((window < 0) & beside((window >= 0) & (window < OCCUPIED_FROM)))
    return (rows + top) * grid.width + columns + left


def _classes(
    models: Mapping[str, RobotModel], robot_cells: Mapping[str, Collection[int]]
) -> list[list[str]]:
    """Types with the same body and terrain, those that carry others first."""
    groups: dict[tuple[bool, float, tuple[str, ...]], list[str]] = {}
    for name, model in models.items():
        if robot_cells.get(name):
            key = (model.capacity == 0, -model.radius_m, tuple(model.enters))
            groups.setdefault(key, []).append(name)
    return [groups[key] for key in sorted(groups)]


def _reached(space: ReachableSpace, robot_cells: Collection[int]) -> NDArray[np.bool_]:
    """(height, width) the cells of a space that some robot can get to."""
    starts = sorted({start for cell in robot_cells if (start := space.snapped(cell)) is not None})
    return space.connected_with(starts)
