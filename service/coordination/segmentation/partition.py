"""Partition of the free space at critical points (Wurm, section 2.4.3).

The cut through a critical point runs to the nearest obstacles on both of its sides: Thrun's
critical line (Artificial Intelligence 99, 1998).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semantic_attachments._core import DistanceTransform, Region
from semantic_attachments.neighbours import beside

Cut = tuple[tuple[int, int], tuple[int, int], tuple[int, int]]
"""(row, column) of one obstacle, of the critical point, and of the obstacle opposite."""


def cuts(points: Sequence[int], distances: DistanceTransform) -> tuple[Cut, ...]:
    """The critical lines of critical points, given by cell."""
    nearest = distances.nearest()
    columns = nearest.shape[1]
    found = []
    for cell in points:
        row, column = divmod(cell, columns)
        window = nearest[max(row - 2, 0) : row + 3, max(column - 2, 0) : column + 3]
        at = np.stack(np.divmod(np.unique(window).astype(np.int64), columns), axis=1)
        first = np.array(divmod(int(nearest[row, column]), columns))
        # The obstacle that lies most nearly opposite, seen from the point.
        away = at - (row, column)
        towards = first - (row, column)
        cosine = (away @ towards) / np.maximum(
            np.linalg.norm(away, axis=1) * np.linalg.norm(towards), 1e-9
        )
        other = at[int(np.argmin(cosine))]
        found.append(
            ((int(first[0]), int(first[1])), (row, column), (int(other[0]), int(other[1])))
        )
    return tuple(found)


def partition(free: NDArray[np.bool_], lines: Sequence[Cut]) -> NDArray[np.int32]:
    """(rows, columns) number of each free cell's segment, from 1; 0 where it is not free."""
    open_cells = free.copy()
    if lines:
        ends = np.array(lines)
        for begin, end in ((ends[:, 0], ends[:, 1]), (ends[:, 1], ends[:, 2])):
            rows, columns = _cells_between(begin, end)
            open_cells[rows, columns] = False
    labels: NDArray[np.int32] = ndimage.label(open_cells)[0].astype(np.int32)
    left_over = np.flatnonzero(free.ravel() & (labels.ravel() == 0))
    if len(left_over):
        _join_nearest(free, labels, left_over)
    return labels


def _join_nearest(
    free: NDArray[np.bool_], labels: NDArray[np.int32], left_over: NDArray[np.int64]
) -> None:
    """Gives the cells of the lines to the segment nearest to them."""
    labelled = (labels > 0) & beside((labels == 0) & free)
    sources = np.flatnonzero(labelled.ravel()).astype(np.uint32)
    goals = left_over.astype(np.uint32)
    nearest = Region(free).geodesic(sources, goals).sources().ravel()[left_over]
    reached = nearest < len(sources)
    labels.ravel()[left_over[reached]] = labels.ravel()[sources[nearest[reached]]]
    # What no way leads to is a segment of its own.
    alone = np.zeros(free.shape, dtype=np.bool_)
    alone.ravel()[left_over[~reached]] = True
    islands, _ = ndimage.label(alone)
    labels[alone] = islands[alone] + labels.max()


def _cells_between(
    begin: NDArray[np.int64], end: NDArray[np.int64]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """All cells that the straight lines between cells' centres (n, 2) touch, so that no diagonal
    step slips through."""
    steps = 4 * int(np.abs(end - begin).max()) + 1
    share = np.linspace(0.0, 1.0, steps + 1)[:, None, None]
    at = begin + share * (end - begin)
    cells = np.concatenate([np.floor(at + 0.5), np.ceil(at - 0.5)]).astype(np.intp).reshape(-1, 2)
    return cells[:, 0], cells[:, 1]
