"""The largest clique of an undirected graph, exact within a budget.

Branch and bound with greedy colouring as the bound, over bit sets (Tomita and Seki, "An Efficient
Branch-and-Bound Algorithm for Finding a Maximum Clique", DMTCS 2003; San Segundo et al. 2011). The
graphs of pairwise consistency are one dense block and noise, where the first descent is optimal and
the colouring proves it at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def maximum_clique(adjacent: NDArray[np.bool_], node_limit: int = 20_000) -> NDArray[np.intp]:
    """Indices of a largest set of vertices that are adjacent two by two.

    Args:
        adjacent: (n, n); an edge counts if both directions are set, the diagonal is ignored.
        node_limit: after so many branches the best clique so far is returned; the problem is
            NP-hard.
    """
    both = adjacent & adjacent.T
    count = len(both)
    np.fill_diagonal(both, False)
    # Vertices by falling degree, so that the greedy colouring is tight.
    order = np.argsort(-both.sum(axis=1), kind="stable")
    ordered = both[np.ix_(order, order)]
    packed = np.packbits(ordered, axis=1, bitorder="little")
    neighbours = [int.from_bytes(row.tobytes(), "little") for row in packed]
    search = _Search(neighbours, node_limit)
    search.expand((1 << count) - 1, [])
    return np.sort(order[search.best])


class _Search:
    def __init__(self, neighbours: list[int], node_limit: int) -> None:
        self.neighbours = neighbours
        self.nodes_left = node_limit
        self.best: list[int] = []

    def expand(self, candidates: int, clique: list[int]) -> None:
        """Tries to grow a clique by candidates (bits) that are adjacent to all of it."""
        vertices, colours = self._coloured(candidates)
        for vertex, colour in zip(reversed(vertices), reversed(colours), strict=True):
            if len(clique) + colour <= len(self.best) or self.nodes_left <= 0:
                return
            self.nodes_left -= 1
            clique.append(vertex)
            rest = candidates & self.neighbours[vertex]
            if rest:
                self.expand(rest, clique)
            elif len(clique) > len(self.best):
                self.best = list(clique)
            clique.pop()
            candidates &= ~(1 << vertex)

    def _coloured(self, candidates: int) -> tuple[list[int], list[int]]:
        """Vertices in classes without edges inside; a class's number bounds cliques up to it."""
        vertices: list[int] = []
        colours: list[int] = []
        colour = 0
        while candidates:
            colour += 1
            free = candidates
            while free:
                lowest = free & -free
                vertex = lowest.bit_length() - 1
                vertices.append(vertex)
                colours.append(colour)
                candidates ^= lowest
                free &= ~(self.neighbours[vertex] | lowest)
        return vertices, colours
