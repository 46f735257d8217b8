"""The unknown area in view of a place."""

from math import pi

import numpy as np
import pytest

from semantic_attachments.world import GridMap
from service.coordination.exploration.expected_area import expected_area_m2

SIZE_M = 0.2


def grid_of(cells: np.ndarray[tuple[int, int], np.dtype[np.int8]]) -> GridMap:
    return GridMap(cells, resolution_m=SIZE_M, origin_m=(-10.0, -10.0))


def test_in_the_middle_of_nowhere_it_is_the_disc_of_the_sensor() -> None:
    nothing = grid_of(np.full((100, 100), -1, dtype=np.int8))
    areas = expected_area_m2(nothing, [(0.0, 0.0), (0.0, 0.0)], [4.0, 2.0])
    assert areas == pytest.approx([pi * 16.0, pi * 4.0], rel=0.02)


def test_what_is_known_does_not_count_and_walls_end_the_view() -> None:
    cells = np.full((100, 100), -1, dtype=np.int8)
    cells[:50] = 0  # known below y = 0
    open_above = grid_of(cells)
    (half,) = expected_area_m2(open_above, [(0.0, -0.1)], [4.0])
    assert half == pytest.approx(pi * 8.0, rel=0.06)
    walled = cells.copy()
    walled[50] = 100
    assert expected_area_m2(grid_of(walled), [(0.0, -0.1)], [4.0]) == [0.0]


def test_beyond_the_map_there_is_nothing() -> None:
    nothing = grid_of(np.full((100, 100), -1, dtype=np.int8))
    (corner,) = expected_area_m2(nothing, [(-10.0 + 1e-6, -10.0 + 1e-6)], [4.0])
    assert corner == pytest.approx(pi * 4.0, rel=0.1)


def test_no_places_no_areas() -> None:
    assert expected_area_m2(grid_of(np.zeros((100, 100), dtype=np.int8)), [], []) == []
