"""The Voronoi graph of a partial grid map (Wurm, section 2.4.1).

Choset and Burdick, "Sensor Based Planning: The Generalized Voronoi Graph", ICRA 1995; from grid
maps as in Niblack, Gibbons and Capson, "Generating Skeletons and Centerlines from the Distance
Transform", 1992. The distance transform and the skeleton along its ridges are native: that of
scikit-image knows no distances, so its lines need not lie in the middle of a doorway.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from semantic_attachments._core import DistanceTransform


@dataclass(frozen=True)
class SkeletonParameters:
    """Which branches of the skeleton count."""

    least_chord_m: float = 0.6
    """Least distance between the two obstacles that a branch runs between [m]."""
    least_chord_ratio: float = 1.2
    """The same relative to their distance from the branch: 2 between parallel walls, 1.41 in a
    right angle."""


@dataclass(frozen=True)
class VoronoiGraph:
    """Cells with two obstacles at the same, least distance; neighbouring cells are joined."""

    shape: tuple[int, int]
    """(rows, columns) of the map."""
    cells: NDArray[np.int64]
    """(n,) the nodes, `row * columns + column`, ascending."""
    clearance_cells: NDArray[np.float32]
    """(n,) `mindist`: distance of each node to the nearest obstacle [cells]."""
    edges: NDArray[np.int64]
    """(m, 2) indices of nodes, the smaller first."""

    def degrees(self) -> NDArray[np.int64]:
        """(n,) number of edges of each node."""
        return np.bincount(self.edges.ravel(), minlength=len(self.cells))

    def biggest_connected_component(self) -> Self:
        """Without what is not connected to most of it (Hopcroft and Tarjan, 1973)."""
        n = len(self.cells)
        if n == 0:
            return self
        ones = np.ones(len(self.edges), dtype=np.int8)
        adjacency = coo_array((ones, (self.edges[:, 0], self.edges[:, 1])), shape=(n, n))
        _, labels = connected_components(adjacency, directed=False)
        kept = labels == np.bincount(labels).argmax()
        renumbered = np.cumsum(kept) - 1
        edges = renumbered[self.edges[kept[self.edges[:, 0]]]]
        return type(self)(self.shape, self.cells[kept], self.clearance_cells[kept], edges)


def voronoi_graph(
    free: NDArray[np.bool_],
    occupied: NDArray[np.bool_],
    resolution_m: float,
    parameters: SkeletonParameters | None = None,
    distances: DistanceTransform | None = None,
) -> VoronoiGraph:
    """The Voronoi graph of the known free space, equations 2.1 and 2.2.

    What is unknown is no obstacle: a corridor's graph ends where the known part of it does, and
    not in forks to the corners of the frontier.

    Args:
        free: (rows, columns) known to be free.
        occupied: (rows, columns) known obstacles.
        distances: the distance transform of `occupied`, if it is at hand.
    """
    parameters = parameters or SkeletonParameters()
    distances = distances or DistanceTransform(occupied)
    skeleton = distances.skeleton(
        ~occupied, parameters.least_chord_m / resolution_m, parameters.least_chord_ratio
    )
    return graph_of(skeleton & free, distances.distances())


def graph_of(skeleton: NDArray[np.bool_], clearance_cells: NDArray[np.float32]) -> VoronoiGraph:
    """The graph whose nodes are a skeleton's cells, (rows, columns) both.

    Diagonal neighbours are joined only where no third cell joins them already.
    """
    rows, columns = skeleton.shape
    padded = np.zeros((rows + 2, columns + 2), dtype=np.bool_)
    padded[1:-1, 1:-1] = skeleton
    width = columns + 2
    flat = padded.ravel()
    at = np.flatnonzero(flat)
    number = np.full(flat.shape, -1, dtype=np.int32)
    number[at] = np.arange(len(at))
    pairs = []
    for step, between in (
        (1, None),
        (width, None),
        (width + 1, (1, width)),
        (width - 1, (-1, width)),
    ):
        joined = flat[at + step]
        if between is not None:
            joined &= ~(flat[at + between[0]] | flat[at + between[1]])
        begin = at[joined]
        pairs.append(np.stack([number[begin], number[begin + step]], axis=1))
    cells = (at // width - 1) * columns + at % width - 1
    edges = np.concatenate(pairs).astype(np.int64)
    edges = edges[np.lexsort((edges[:, 1], edges[:, 0]))]
    return VoronoiGraph((rows, columns), cells, clearance_cells.ravel()[cells], edges)
