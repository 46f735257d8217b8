"""How much there may be to explore from a segment of the map: what a large team is spread by."""

import numpy as np
from numpy.typing import NDArray

from semantic_attachments._core import Region
from semantic_attachments.neighbours import beside
from semantic_attachments.world import OCCUPIED_FROM, GridMap


def unknown_ahead(
    grid: GridMap, labels: NDArray[np.int32], range_cells: float
) -> NDArray[np.int64]:
    """(segments + 1,) unknown cells within range of each segment's frontiers, by its number.

    Ways lead through whatever is not known to be an obstacle; a cell counts for the frontier that
    it is nearest to. The length of the frontiers says less: what is left of a room in the shadows
    of its furniture has long ones, a room seen through its door a short one. Linear in the cells.

    Args:
        labels: (rows, columns) number of each free cell's segment, from 1; 0 elsewhere.
        range_cells: the sensor range [cells].
    """
    unknown = grid.cells < 0
    occupied = grid.cells >= OCCUPIED_FROM
    frontier = beside(unknown) & ~unknown & ~occupied & (labels > 0)
    sources = np.flatnonzero(frontier.ravel()).astype(np.uint32)
    segments = int(labels.max()) + 1
    if not len(sources):
        return np.zeros(segments, dtype=np.int64)
    ways = Region(~occupied).geodesic(sources)
    near = np.flatnonzero(unknown.ravel() & (ways.lengths().ravel() <= range_cells))
    nearest = ways.sources().ravel()[near]
    return np.bincount(labels.ravel()[sources[nearest]], minlength=segments)
