"""Changes far from a motion do not touch it."""

import numpy as np
import pytest

from semantic_attachments.motion_change import Box, changed_cells, touches
from semantic_attachments.world import Blockade, GridMap

GRID = GridMap(np.zeros((40, 50), np.int8), resolution_m=0.2, origin_m=(-1.0, 2.0))


def test_a_box_is_as_far_as_its_nearest_point() -> None:
    box = Box.around(Blockade("rubble", ((2.0, 5.0), (4.0, 3.0)), 1.0, thickness_m=0.2))
    assert (box.low_m, box.high_m) == ((1.9, 2.9), (4.1, 5.1))
    assert box.away_m((3.0, 4.0)) == 0.0
    assert box.away_m((7.1, 1.0 - 2.1)) == pytest.approx(5.0)


def test_the_region_of_changed_cells() -> None:
    cells = GRID.cells.copy()
    cells[10, 20] = cells[12, 25] = 100
    (box,) = changed_cells(GRID, GridMap(cells, 0.2, (-1.0, 2.0))) or []
    assert box.low_m == pytest.approx((3.0, 4.0))
    assert box.high_m == pytest.approx((4.2, 4.6))
    assert changed_cells(GRID, GridMap(GRID.cells, 0.2, (-1.0, 2.0))) == []
    assert changed_cells(GRID, GridMap(GRID.cells, 0.2)) is None
    terrain = np.zeros((40, 50), np.uint8)
    terrain[0, 0] = 1
    classes = ("default", "mud")
    plain, muddy = (
        GridMap(GRID.cells, 0.2, terrain=kind, terrain_classes=classes) for kind in (None, terrain)
    )
    (box,) = changed_cells(plain, muddy) or []
    assert box.high_m == pytest.approx((0.2, 0.2))


@pytest.mark.parametrize(("length_m", "expected"), [(10.0, False), (13.9, False), (14.1, True)])
def test_a_motion_is_touched_within_its_length(length_m: float, expected: bool) -> None:
    post = Box((5.0, 5.0), (5.0, 5.0))
    ends = ((0.0, 0.0), (10.0, 0.0))
    assert touches([post], ends, length_m, reach_m=0.1) is expected
    assert not touches([], ends, length_m, reach_m=0.1)
