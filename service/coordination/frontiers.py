"""Frontiers: where known free space ends, as targets of exploration.

Yamauchi, "A Frontier-Based Approach for Autonomous Exploration", CIRA 1997; neighbouring frontiers
are joined by visibility as in Burgard, Moors, Stachniss and Schneider, "Coordinated Multi-Robot
Exploration", IEEE Transactions on Robotics 21 (2005), section III. Only cells that one connected
component of one kind of traversable space reaches are joined, so that no target lies in a pocket
that nobody can enter.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semantic_attachments.neighbours import beside

EIGHT_NEIGHBOURS = np.ones((3, 3), dtype=np.int8)


@dataclass(frozen=True, slots=True)
class Frontier:
    """A place from which something unknown can be seen."""

    cell: tuple[int, int]
    """(row, column) of the frontier cell nearest the centroid"""
    cells: int
    """number of frontier cells that it stands for"""
    component: int
    """label of the connected traversable space that it lies in"""


def frontiers(
    traversable: NDArray[np.bool_],
    unknown: NDArray[np.bool_],
    *,
    visible_cells: float,
    least_cells: int = 2,
) -> tuple[Frontier, ...]:
    """Frontiers of one traversability class, the largest first, ties by row and column.

    `traversable` and `unknown` are (rows, columns); `visible_cells` is the sensor range, within
    which frontiers that see one another become one; clusters below `least_cells` cells are left
    out. Linear in the cells but for the joining, which is quadratic in the number of clusters.
    """
    # By edges: across a corner nothing is to be seen.
    border = traversable & beside(unknown)
    if not border.any():
        return ()
    components, _ = ndimage.label(traversable, EIGHT_NEIGHBOURS)
    parts = [cells for cells in clusters(border) if len(cells) >= least_cells]
    parts.sort(key=lambda cells: (-len(cells), *cells[0].tolist()))
    seen_from: list[list[NDArray[np.int64]]] = []
    places: list[tuple[int, int]] = []
    for cells in parts:
        place = _nearest_centroid(cells)
        for index, other in enumerate(places):
            connected = components[place] == components[other]
            if connected and _sees(place, other, traversable, visible_cells):
                seen_from[index].append(cells)
                break
        else:
            places.append(place)
            seen_from.append([cells])
    return tuple(
        Frontier(place, sum(len(cells) for cells in joined), int(components[place]))
        for place, joined in zip(places, seen_from, strict=True)
    )


def clusters(border: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """(n, 2) rows and columns of each 8-connected cluster, in row-major order."""
    cells = np.argwhere(border)
    if not len(cells):
        return []
    labels, _ = ndimage.label(border, EIGHT_NEIGHBOURS)
    label_of = labels[border]
    order = np.argsort(label_of, kind="stable")
    ends = np.flatnonzero(np.diff(label_of[order])) + 1
    return np.split(cells[order], ends)


def _nearest_centroid(cells: NDArray[np.int64]) -> tuple[int, int]:
    """The cell nearest the centroid; the centroid itself may lie in a wall."""
    row, column = cells[np.argmin(np.linalg.norm(cells - cells.mean(axis=0), axis=1))].tolist()
    return (int(row), int(column))


def _sees(
    a: tuple[int, int], b: tuple[int, int], traversable: NDArray[np.bool_], range_cells: float
) -> bool:
    """Whether the straight line between two cells is short enough and free."""
    apart = float(np.hypot(a[0] - b[0], a[1] - b[1]))
    if apart > range_cells:
        return False
    ratios = np.linspace(0.0, 1.0, 2 * int(apart) + 2)
    rows = np.rint(a[0] + ratios * (b[0] - a[0])).astype(np.intp)
    columns = np.rint(a[1] + ratios * (b[1] - a[1])).astype(np.intp)
    return bool(traversable[rows, columns].all())
