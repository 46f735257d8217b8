"""Cells next to those of a mask.

Shifted copies of the whole mask: tens of times faster than general morphology, which decisions on
large maps call for again and again.
"""

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]
"""(height, width)"""


def beside(cells: Mask) -> Mask:
    """The cells that share an edge with one of some cells."""
    near = np.zeros_like(cells)
    near[1:] |= cells[:-1]
    near[:-1] |= cells[1:]
    near[:, 1:] |= cells[:, :-1]
    near[:, :-1] |= cells[:, 1:]
    return near


def grown(cells: Mask) -> Mask:
    """Some cells and those that share an edge or a corner with one of them."""
    wider = cells.copy()
    wider[:, 1:] |= cells[:, :-1]
    wider[:, :-1] |= cells[:, 1:]
    result = wider.copy()
    result[1:] |= wider[:-1]
    result[:-1] |= wider[1:]
    return result
