"""One-to-all distances against scipy's Dijkstra and scikit-image's MCP_Geometric, same graph."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from scenarios.benchmarks.attachments.measuring import cpu_s, table
from semantic_attachments._core import Traversability

SEED = 7


def run(*, quick: bool) -> str:
    """Ratios on a map with obstacles (scipy only, since MCP cuts corners) and on open terrain."""
    size = 300 if quick else 1000
    rng = np.random.default_rng(SEED)
    obstacles = rng.random((size, size)) < 0.2
    obstacles[size // 2, size // 2] = False
    open_ground = np.zeros_like(obstacles)
    terrain = rng.integers(1, 4, (size, size)).astype(np.float32)
    rows = [
        compare("no obstacles", open_ground, None),
        compare("20 % obstacles", obstacles, None),
        compare("three kinds of terrain", open_ground, terrain),
    ]
    columns = [
        "map", "native [s]", "scipy [s]", "scipy / native", "largest difference", "MCP [s]",
        "MCP / native", "largest difference",
    ]  # fmt: skip
    return table(f"One to all, {size} x {size} cells", columns, rows)


def compare(
    name: str, solid: NDArray[np.bool_], factors: NDArray[np.float32] | None
) -> list[object]:
    """A row of the table."""
    height, width = solid.shape
    source = (height // 2) * width + width // 2
    map_ = Traversability(solid, np.zeros_like(solid), 0.0, factors)
    native_s, field = cpu_s(lambda: map_.field(source), repeats=5)
    found = field.distances()
    graph = edges(solid, factors)
    scipy_s, expected = cpu_s(lambda: dijkstra(graph, indices=source).reshape(solid.shape))
    row: list[object] = [name, native_s, scipy_s, scipy_s / native_s, difference(found, expected)]
    if solid.any():
        return [*row, "-", "-", "corners cut"]
    try:
        from skimage.graph import MCP_Geometric
    except ImportError:
        return [*row, "-", "-", "not installed"]
    costs = np.ones(solid.shape) if factors is None else factors.astype(np.float64)
    start = divmod(source, width)
    mcp_s, other = cpu_s(lambda: MCP_Geometric(costs, fully_connected=True).find_costs([start])[0])
    return [*row, mcp_s, mcp_s / native_s, difference(found, other)]


def difference(found: NDArray[np.float64], expected: NDArray[np.float64]) -> float:
    """Largest difference of two fields; infinite where only one of them is."""
    if not np.array_equal(np.isfinite(found), np.isfinite(expected)):
        return float("inf")
    reached = np.isfinite(found)
    return float(np.abs(found[reached] - expected[reached]).max())


def edges(solid: NDArray[np.bool_], factors: NDArray[np.float32] | None) -> csr_array:
    """The 8-connected graph without cut corners as a symmetric sparse matrix."""
    free = ~solid
    cells = np.arange(solid.size).reshape(solid.shape)
    costs = np.ones(solid.shape) if factors is None else factors.astype(np.float64)
    starts, goals, lengths = [], [], []
    for up, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = (
            slice(0, solid.shape[0] - up),
            slice(max(-right, 0), solid.shape[1] - max(right, 0)),
        )
        there = (slice(up, None), slice(max(right, 0), solid.shape[1] + min(right, 0)))
        usable = free[here] & free[there]
        if up and right:
            usable &= free[here[0], there[1]] & free[there[0], here[1]]
        step = np.hypot(up, right) * 0.5 * (costs[here] + costs[there])
        starts.append(cells[here][usable])
        goals.append(cells[there][usable])
        lengths.append(step[usable])
    a, b, length = (np.concatenate(parts) for parts in (starts, goals, lengths))
    both = (np.concatenate([length, length]), (np.concatenate([a, b]), np.concatenate([b, a])))
    return csr_array(coo_array(both, shape=(solid.size, solid.size)))
