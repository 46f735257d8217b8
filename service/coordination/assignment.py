"""Rules that give each robot one target by its travel time: Hungarian method, nearest pair first.

The Hungarian method is Kuhn's (1955), used as in thesis 2.3.
"""

from collections.abc import Sequence
from math import isfinite
from typing import Protocol

import numpy as np
from scipy.optimize import linear_sum_assignment

from service.coordination.travel import Travel


class AssignmentRule(Protocol):
    """Chooses the goal that each robot goes to next."""

    def __call__(
        self, travel: Travel, robots: Sequence[str], goals: Sequence[str], *, share: bool = False
    ) -> dict[int, int]:
        """Index of each robot's goal; a robot that can reach none, or is left without, is not in.

        Args:
            share: robots for which no goal is left go to one that another robot has.
        """
        ...


def by_hungarian_method(
    travel: Travel, robots: Sequence[str], goals: Sequence[str], *, share: bool = False
) -> dict[int, int]:
    """The assignment of least total travel time."""
    return hungarian(travel.times_s(robots, goals), share=share)


def by_nearest_pair(
    travel: Travel, robots: Sequence[str], goals: Sequence[str], *, share: bool = False
) -> dict[int, int]:
    """The nearest pair of robot and goal first, then the nearest of what is left, and so on."""
    return nearest_pairs(travel.times_s(robots, goals), share=share)


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


def nearest_pairs(costs: Sequence[Sequence[float]], *, share: bool = False) -> dict[int, int]:
    """Column of each row, taking pairs in the order of their costs.

    Args:
        costs: (rows, columns); infinite where a robot cannot do a task.
        share: rows left over take their own cheapest column.
    """
    pairs = sorted(
        (cost, row, column)
        for row, line in enumerate(costs)
        for column, cost in enumerate(line)
        if isfinite(cost)
    )
    chosen: dict[int, int] = {}
    taken: set[int] = set()
    for _, row, column in pairs:
        if row not in chosen and column not in taken:
            chosen[row] = column
            taken.add(column)
    if share:
        for _, row, column in pairs:
            chosen.setdefault(row, column)
    return chosen
