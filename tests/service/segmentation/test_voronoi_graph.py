"""Voronoi graphs of drawn floors: `.` free, `#` wall, `?` unknown."""

import networkx as nx
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.measure import euler_number

from service.coordination.segmentation.voronoi_graph import graph_of, voronoi_graph


def drawn(rows: list[str]) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Free and occupied cells; the first row is the lowest."""
    cells = np.array([list(row) for row in rows])
    return cells == ".", cells == "#"


def test_a_corridor_is_a_path_along_its_middle() -> None:
    graph = voronoi_graph(*drawn(["#" * 30, *["#" + "." * 28 + "#"] * 5, "#" * 30]), 0.2)
    rows = graph.cells // 30
    inner = (graph.cells % 30 > 5) & (graph.cells % 30 < 24)
    assert (rows[inner] == 3).all()
    assert inner.sum() == 18
    assert (graph.clearance_cells[inner] == 3.0).all()


def test_a_corridor_that_ends_in_the_unknown_does_not_fork_there() -> None:
    graph = voronoi_graph(
        *drawn(["#" * 20 + "?" * 10, *["#" + "." * 19 + "?" * 10] * 5, "#" * 20 + "?" * 10]), 0.2
    )
    near_end = graph.cells % 30 > 8
    assert (graph.cells[near_end] // 30 == 3).all()


def test_skeletons_of_random_floors_keep_parts_and_holes() -> None:
    """Against scikit-image's Euler number (8-connected) and scipy's count of parts."""
    random = np.random.default_rng(3)
    for _ in range(20):
        occupied = ndimage.binary_dilation(random.random((40, 60)) < 0.02, iterations=2)
        free = ~occupied
        graph = voronoi_graph(free, occupied, 0.2)
        skeleton = np.zeros(free.shape, dtype=np.bool_)
        skeleton.ravel()[graph.cells] = True
        assert not (skeleton & occupied).any()
        eight = np.ones((3, 3), dtype=np.int8)
        assert ndimage.label(skeleton, eight)[1] == ndimage.label(free, eight)[1]
        assert euler_number(skeleton, connectivity=2) == euler_number(free, connectivity=2)


def test_edges_join_neighbours_and_no_corner_is_a_triangle() -> None:
    skeleton = np.zeros((5, 6), dtype=np.bool_)
    skeleton[1, 1:4] = True
    skeleton[2, 3] = True
    skeleton[3, 4] = True
    graph = graph_of(skeleton, np.ones((5, 6), dtype=np.float32))
    at = {(int(c) // 6, int(c) % 6): k for k, c in enumerate(graph.cells)}
    expected = {((1, 1), (1, 2)), ((1, 2), (1, 3)), ((1, 3), (2, 3)), ((2, 3), (3, 4))}
    assert {tuple(edge) for edge in graph.edges.tolist()} == {(at[a], at[b]) for a, b in expected}


def test_the_biggest_component_is_that_of_networkx() -> None:
    random = np.random.default_rng(5)
    for _ in range(10):
        graph = graph_of(random.random((20, 20)) < 0.35, np.ones((20, 20), dtype=np.float32))
        reference = nx.Graph(graph.edges.tolist())
        reference.add_nodes_from(range(len(graph.cells)))
        biggest = max(len(part) for part in nx.connected_components(reference))
        kept = graph.biggest_connected_component()
        assert len(kept.cells) == biggest
        assert set(kept.cells) <= set(graph.cells)
        parts = nx.Graph(kept.edges.tolist())
        assert biggest == 1 or nx.is_connected(parts)


def test_an_empty_map_has_an_empty_graph() -> None:
    nothing = np.zeros((4, 4), dtype=np.bool_)
    graph = voronoi_graph(nothing, ~nothing, 0.2).biggest_connected_component()
    assert len(graph.cells) == 0
    assert len(graph.edges) == 0
