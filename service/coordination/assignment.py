"""Target assignment with the Hungarian method (thesis 2.3; Kuhn, 1955)."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment


def hungarian(costs: Sequence[Sequence[float]], *, share: bool = False) -> dict[int, int]:
    """Column of each row in the assignment of least total cost.

    A row whose every cost is infinite, or for which no column is left, is not in the answer. As
    few rows as possible go without a finite cost.

    Args:
        costs: (rows, columns), rows being robots; infinite where a robot cannot do a task.
        share: duplicate the columns if there are more rows, as the thesis does with targets.
    """
    matrix = np.asarray(costs, dtype=np.float64)
    if matrix.size == 0:
        return {}
    rows, columns = matrix.shape
    if share and rows > columns:
        matrix = np.tile(matrix, (1, -(-rows // columns)))
    finite = np.isfinite(matrix)
    # Above the sum of all finite costs: no gain makes up for one pair that is not feasible.
    forbidden = float(matrix[finite].sum()) + 1.0
    chosen = linear_sum_assignment(np.where(finite, matrix, forbidden))
    return {
        int(row): int(column) % columns
        for row, column in zip(*chosen, strict=True)
        if finite[row, column]
    }
