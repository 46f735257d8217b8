"""The Hungarian method against exhaustive search (thesis 2.3)."""

import itertools
from math import inf, isfinite

import numpy as np
import pytest

from service.coordination.assignment import hungarian, nearest_pairs


def test_four_robots_and_four_areas() -> None:
    costs = [[5.0, 9.0, 1.0, 7.0], [2.0, 8.0, 4.0, 6.0], [7.0, 3.0, 9.0, 8.0], [4.0, 6.0, 5.0, 2.0]]
    assert hungarian(costs) == {0: 2, 1: 0, 2: 1, 3: 3}


@pytest.mark.parametrize("seed", range(30))
def test_no_assignment_is_cheaper(seed: int) -> None:
    random = np.random.default_rng(seed)
    rows, columns = random.integers(1, 6, size=2)
    costs = random.integers(1, 20, size=(rows, columns)).astype(float)
    costs[random.random((rows, columns)) < 0.3] = inf
    chosen = hungarian(costs.tolist())
    assert all(isfinite(costs[row, column]) for row, column in chosen.items())
    assert len(set(chosen.values())) == len(chosen)
    assert (len(chosen), -sum(costs[r, c] for r, c in chosen.items())) == best(costs)


def best(costs: np.ndarray) -> tuple[int, float]:
    """Most rows served, then least cost, by trying all."""
    rows, columns = costs.shape
    found = (0, 0.0)
    padded = [*range(columns), *[None] * rows]
    for choice in set(itertools.permutations(padded, rows)):
        pairs = [(r, c) for r, c in enumerate(choice) if c is not None]
        if all(isfinite(costs[r, c]) for r, c in pairs):
            found = max(found, (len(pairs), -float(sum(costs[r, c] for r, c in pairs))))
    return found


def test_more_robots_than_targets_share_them() -> None:
    assert hungarian([[1.0], [2.0], [3.0]], share=True) == {0: 0, 1: 0, 2: 0}
    assert hungarian([[1.0], [2.0], [3.0]]) == {0: 0}


def test_nothing_to_assign() -> None:
    assert hungarian([]) == {}
    assert hungarian([[]]) == {}
    assert hungarian([[inf]]) == {}


def test_nearest_pairs_are_taken_in_order() -> None:
    assert nearest_pairs([[2.0, 3.0], [1.0, 9.0]]) == {1: 0, 0: 1}
    assert nearest_pairs([[2.0], [1.0], [inf]]) == {1: 0}
    assert nearest_pairs([[2.0], [1.0], [inf]], share=True) == {1: 0, 0: 0}
