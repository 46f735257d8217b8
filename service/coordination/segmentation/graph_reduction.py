"""Reduction of a Voronoi graph to what matters for a partition (Wurm, Algorithm 1)."""

from collections.abc import Mapping
from dataclasses import dataclass

from service.coordination.segmentation.voronoi_graph import VoronoiGraph


@dataclass(frozen=True)
class ReducedGraph:
    """What is left: junctions, local minima of the clearance, and ends of removed spurs."""

    shape: tuple[int, int]
    """(rows, columns) of the map."""
    neighbours: Mapping[int, tuple[int, ...]]
    """Neighbours of each node, by cell `row * columns + column`, ascending."""
    clearance_cells: Mapping[int, float]
    """`mindist`: distance of each node to the nearest obstacle [cells]."""


def reduced(graph: VoronoiGraph) -> ReducedGraph:
    """Algorithm 1, line by line; linear in the nodes.

    Where lines 3 and 13 say "for all nodes", the set is the one at the beginning of the loop and
    its order that of the cells. A node whose degree has changed since, because both its
    neighbours had been joined already, stays.
    """
    # 1: restrict to the biggest connected component
    graph = graph.biggest_connected_component()
    mindist = graph.clearance_cells.tolist()
    neighbours: list[set[int]] = [set() for _ in mindist]
    for a, b in graph.edges.tolist():
        neighbours[a].add(b)
        neighbours[b].add(a)
    nobody: set[int] = set()
    # 2 to 11: remove redundant nodes with degree 2
    for v in [v for v, joined in enumerate(neighbours) if len(joined) == 2]:
        joined = neighbours[v]
        if len(joined) != 2:
            continue
        left, right = joined
        if mindist[left] <= mindist[v] or mindist[right] <= mindist[v]:
            neighbours[v] = nobody
            of_left, of_right = neighbours[left], neighbours[right]
            of_left.remove(v)
            of_left.add(right)
            of_right.remove(v)
            of_right.add(left)
    # 12 to 16: remove nodes with degree 1
    for v in [v for v, joined in enumerate(neighbours) if len(joined) == 1]:
        for other in neighbours[v]:
            neighbours[other].discard(v)
        neighbours[v] = nobody
    cells = graph.cells.tolist()
    kept = [v for v, joined in enumerate(neighbours) if joined]
    return ReducedGraph(
        graph.shape,
        {cells[v]: tuple(sorted(cells[u] for u in neighbours[v])) for v in kept},
        {cells[v]: mindist[v] for v in kept},
    )
