"""Critical points: where a Voronoi graph is cut into segments (Wurm, section 2.4.3)."""

import numpy as np
from numpy.typing import NDArray

from service.coordination.segmentation.graph_reduction import ReducedGraph

JUNCTION_DEGREE = 3


def local_minima(graph: ReducedGraph) -> tuple[int, ...]:
    """Nodes nearer to obstacles than all their neighbours, by cell.

    Thrun, "Learning Metric-Topological Maps for Indoor Mobile Robot Navigation", Artificial
    Intelligence 99 (1998): doorways and other narrow passages, and much else in clutter.
    """
    clearance = graph.clearance_cells
    return tuple(
        cell
        for cell, joined in graph.neighbours.items()
        if joined and all(clearance[cell] < clearance[other] for other in joined)
    )


def at_junctions(graph: ReducedGraph) -> tuple[int, ...]:
    """Local minima of degree 2 with a junction beside them: the first constraint of 2.4.3.

    A junction is a node of degree 3, or more where corridors cross.
    """
    return tuple(
        cell
        for cell in local_minima(graph)
        if len(graph.neighbours[cell]) == 2
        and any(len(graph.neighbours[other]) >= JUNCTION_DEGREE for other in graph.neighbours[cell])
    )


def critical_points(graph: ReducedGraph, unknown_cells: NDArray[np.float32]) -> tuple[int, ...]:
    """Those of them that lead from known into unknown space: both constraints of 2.4.3.

    Across such a point the way to the nearest unknown cell gets shorter all along.

    Args:
        unknown_cells: (rows, columns) length of the way to the nearest unknown cell [cells].
    """
    way = unknown_cells.ravel()
    return tuple(cell for cell in at_junctions(graph) if _leads_on(way, cell, graph))


def _leads_on(way: NDArray[np.float32], cell: int, graph: ReducedGraph) -> bool:
    a, b = (float(way[other]) for other in graph.neighbours[cell])
    here = float(way[cell])
    return min(a, b) < here < max(a, b)
