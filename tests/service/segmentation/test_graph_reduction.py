"""Algorithm 1 on small graphs, and against a literal transcription with networkx."""

import networkx as nx
import numpy as np

from service.coordination.segmentation.graph_reduction import reduced
from service.coordination.segmentation.voronoi_graph import VoronoiGraph, graph_of


def chain(clearances: list[float], edges: list[tuple[int, int]] | None = None) -> VoronoiGraph:
    """Nodes 0, 1, ...; consecutive ones are joined if no edges are given."""
    n = len(clearances)
    pairs = edges if edges is not None else [(k, k + 1) for k in range(n - 1)]
    return VoronoiGraph(
        (1, n), np.arange(n), np.array(clearances, dtype=np.float32), np.array(pairs)
    )


def test_a_doorway_between_two_rooms_survives() -> None:
    # Two rooms (large clearance in their middles), spurs to two corners each, a doorway between.
    #   0 \            / 9
    #      2 3 4 5 6 7
    #   1 /            \ 8
    clearances = [1.0, 1.0, 9.0, 6.0, 3.0, 4.0, 7.0, 9.0, 1.0, 1.0]
    edges = [(0, 2), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 7), (7, 8), (7, 9)]
    graph = reduced(chain(clearances, edges))
    assert graph.neighbours == {2: (4,), 4: (2, 7), 7: (4,)}
    assert graph.clearance_cells[4] == 3.0


def test_of_a_plateau_one_node_stays() -> None:
    edges = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (0, 7), (0, 8), (6, 9), (6, 10)]
    graph = reduced(chain([9.0, 5.0, 2.0, 2.0, 2.0, 5.0, 9.0, 1.0, 1.0, 1.0, 1.0], edges))
    minima = [node for node in graph.neighbours if graph.clearance_cells[node] == 2.0]
    assert len(minima) == 1


def literally(graph: VoronoiGraph) -> nx.Graph:
    """Algorithm 1 as printed."""
    full = nx.Graph(graph.edges.tolist())
    g = nx.Graph(full.subgraph(max(nx.connected_components(full), key=len)))
    mindist = graph.clearance_cells
    for v in sorted(v for v in g if g.degree(v) == 2):
        if g.degree(v) != 2:
            continue
        left, right = g.neighbors(v)
        if mindist[left] <= mindist[v] or mindist[right] <= mindist[v]:
            g.remove_node(v)
            g.add_edge(left, right)
    for v in sorted(v for v in g if g.degree(v) == 1):
        g.remove_node(v)
    g.remove_nodes_from([v for v in list(g) if g.degree(v) == 0])
    return g


def test_random_graphs_reduce_as_the_algorithm_says() -> None:
    random = np.random.default_rng(11)
    for _ in range(30):
        cells = random.random((12, 12)) < 0.45
        graph = graph_of(cells, random.integers(1, 6, (12, 12)).astype(np.float32))
        if len(graph.edges) == 0:
            continue
        biggest = graph.biggest_connected_component()
        expected = literally(biggest)
        found = reduced(graph)
        names = biggest.cells.tolist()
        assert set(found.neighbours) == {names[v] for v in expected}
        for v in expected:
            assert found.neighbours[names[v]] == tuple(sorted(names[u] for u in expected[v]))
