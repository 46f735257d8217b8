"""Meeting points: where carriers put rovers down and take them up (thesis 3.4.1).

They lie on the border between what carriers can drive on and what only rovers can. They stay
where they are while that is part of the border, so that plans and robots can refer to them although
the border that is known grows.
"""

from collections.abc import Mapping, Sequence
from math import ceil

import numpy as np
from numpy.typing import NDArray

from domains.mission_state import MeetingPoint
from semantic_attachments.neighbours import grown
from semantic_attachments.world import GridMap, RobotModel
from service.coordination.frontiers import clusters

FREE_BELOW = 65
SPACING_M = 10.0
"""A border longer than this has more than one meeting point."""
PREFIX = "meeting "
"""How ids of meeting points begin; they hold a space, which no id of a fleet does."""


def meeting_points(
    grid: GridMap, models: Mapping[str, RobotModel], kept: Sequence[MeetingPoint] = ()
) -> tuple[MeetingPoint, ...]:
    """Meeting points of carriers (types with a capacity) and all other robots, in the map frame.

    One for each connected stretch of border, at the cell nearest its centroid; long stretches are
    cut into pieces first. Their ids are the cells they lie in; they hold a space, which no id of a
    fleet does.

    Args:
        kept: the meeting points of before; a piece of border that has some gets no other.
    """
    carriers = [model for model in models.values() if model.capacity > 0]
    riders = [model for model in models.values() if model.capacity == 0]
    if not carriers or not riders or grid.terrain is None:
        return ()
    for_carriers = _enterable(grid, carriers)
    for_riders_only = _enterable(grid, riders) & ~for_carriers
    border = for_carriers & grown(for_riders_only)
    stretches = clusters(border)
    pieces = [piece for cells in stretches for piece in _cut(cells, grid.resolution_m)]
    cells = [(point, grid.cell_at(point.position_m)) for point in kept]
    there = {cell: point for point, cell in cells if cell is not None and border.flat[cell]}
    found = list(there.values())
    for piece in pieces:
        if there.keys().isdisjoint((piece @ [grid.width, 1]).tolist()):
            row, column = _middle(piece)
            found.append(MeetingPoint(f"{PREFIX}{row} {column}", _centre_m(grid, row, column)))
    return tuple(found)


def is_meeting_point(place: str | None) -> bool:
    """Whether the id of a place is that of a meeting point."""
    return place is not None and place.startswith(PREFIX)


def _enterable(grid: GridMap, models: Sequence[RobotModel]) -> NDArray[np.bool_]:
    classes = np.array(
        [any(name in model.enters for model in models) for name in grid.terrain_classes]
    )
    if grid.terrain is None:
        return np.zeros_like(grid.cells, dtype=np.bool_)
    known_free = (grid.cells >= 0) & (grid.cells < FREE_BELOW)
    enterable: NDArray[np.bool_] = known_free & classes.take(grid.terrain)
    return enterable


def _cut(cells: NDArray[np.int64], resolution_m: float) -> list[NDArray[np.int64]]:
    """Pieces of a stretch of border, along its longer side."""
    extent = cells.max(axis=0) - cells.min(axis=0)
    count = max(1, ceil(float(extent.max()) * resolution_m / SPACING_M))
    ordered = cells[np.argsort(cells[:, int(np.argmax(extent))], kind="stable")]
    return [piece for piece in np.array_split(ordered, count) if len(piece)]


def _middle(cells: NDArray[np.int64]) -> tuple[int, int]:
    """Row and column of the cell nearest the centroid."""
    row, column = cells[np.argmin(np.linalg.norm(cells - cells.mean(axis=0), axis=1))]
    return int(row), int(column)


def _centre_m(grid: GridMap, row: int, column: int) -> tuple[float, float]:
    """The centre of a cell in the map frame."""
    return (
        grid.origin_m[0] + (column + 0.5) * grid.resolution_m,
        grid.origin_m[1] + (row + 0.5) * grid.resolution_m,
    )
