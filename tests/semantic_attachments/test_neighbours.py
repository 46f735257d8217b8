"""Cells next to those of a mask, beside scipy's morphology."""

import numpy as np
import pytest
from scipy import ndimage

from semantic_attachments.neighbours import beside, grown

SHAPES = [(1, 1), (1, 7), (9, 1), (2, 2), (23, 40)]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("share", [0.0, 0.05, 0.5, 1.0])
def test_cells_and_their_neighbours_are_a_dilation(shape: tuple[int, int], share: float) -> None:
    cells = np.random.default_rng(7).random(shape) < share
    before = cells.copy()
    by_edges = ndimage.binary_dilation(cells, ndimage.generate_binary_structure(2, 1))
    assert np.array_equal(cells | beside(cells), by_edges)
    assert np.array_equal(grown(cells), ndimage.binary_dilation(cells, np.ones((3, 3))))
    assert np.array_equal(cells, before)


def test_a_cell_is_not_beside_itself() -> None:
    cells = np.zeros((3, 3), dtype=bool)
    cells[1, 1] = True
    expected = [[False, True, False], [True, False, True], [False, True, False]]
    assert beside(cells).tolist() == expected
