"""What may be explored from a segment: counted by ways through what is not known to be a wall."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import lil_array
from scipy.sparse.csgraph import dijkstra

from semantic_attachments.world import GridMap
from service.coordination.exploration.unknown_ahead import unknown_ahead


def grid(*rows: str) -> GridMap:
    """`.` free, `#` occupied, `?` unknown; the first row is on top."""
    values = {".": 0, "#": 100, "?": -1}
    cells = [[values[mark] for mark in row] for row in reversed(rows)]
    return GridMap(np.array(cells, dtype=np.int8), 1.0)


def test_unknown_cells_count_for_the_nearest_segment_and_not_through_walls() -> None:
    world = grid(
        "??#????",
        "..#..??",
        "??#????",
    )
    labels = np.zeros((3, 7), np.int32)
    labels[1, :2], labels[1, 3:5] = 1, 2
    assert unknown_ahead(world, labels, 1.0).tolist() == [0, 4, 5]
    # Two cells further on the right: the corners, each by a diagonal, and the last cell.
    assert unknown_ahead(world, labels, 2.0).tolist() == [0, 4, 8]
    assert unknown_ahead(world, labels, 9.0).tolist() == [0, 4, 10]


def test_nothing_lies_ahead_where_all_is_known() -> None:
    labels = np.ones((1, 4), np.int32)
    assert unknown_ahead(grid("...."), labels, 5.0).tolist() == [0, 0]


def test_every_cell_in_range_is_counted_once() -> None:
    random = np.random.default_rng(5)
    for _ in range(10):
        cells = random.choice(np.array([-1, 0, 100], np.int8), (12, 15), p=(0.5, 0.35, 0.15))
        labels = np.where(cells == 0, random.integers(1, 4, cells.shape), 0).astype(np.int32)
        found = unknown_ahead(GridMap(cells, 1.0), labels, 3.0)
        lengths = _ways(cells)
        assert found.sum() == int(((cells < 0) & (lengths <= 3.0 + 1e-4)).sum())


def _ways(cells: NDArray[np.int8]) -> NDArray[np.float64]:
    """Oracle: ways from free cells beside unknown ones, no diagonal past an obstacle's corner."""
    rows, columns = cells.shape
    open_cells = cells < 65
    joined = lil_array((cells.size, cells.size))
    for row, column in np.argwhere(open_cells):
        for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
            there = row + down, column + right
            if not (there[0] < rows and 0 <= there[1] < columns and open_cells[there]):
                continue
            if open_cells[row, there[1]] and open_cells[there[0], column]:
                joined[row * columns + column, there[0] * columns + there[1]] = np.hypot(
                    down, right
                )
    frontier = [
        row * columns + column
        for row, column in np.argwhere(cells == 0)
        if any(
            0 <= row + a < rows and 0 <= column + b < columns and cells[row + a, column + b] < 0
            for a, b in ((0, 1), (1, 0), (0, -1), (-1, 0))
        )
    ]
    ways = dijkstra(joined.tocsr(), directed=False, indices=frontier, min_only=True)
    return np.asarray(ways).reshape(cells.shape)
