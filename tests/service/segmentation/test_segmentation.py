"""Segmentation of drawn floors."""

import numpy as np
import pytest
from numpy.typing import NDArray

from service.coordination.segmentation.segmentation import (
    THESIS,
    SegmentationParameters,
    segment,
    segment_labels,
    way_to_unknown,
)

MINIMA = SegmentationParameters()


def floor(*, furniture: bool = False) -> NDArray[np.int8]:
    """Two rooms of 6 x 6 m above a corridor of 13 m, doorways of 1 m; 0.2 m cells."""
    cells = np.full((44, 67), 100, dtype=np.int8)
    cells[1:11, 1:66] = 0
    cells[12:43, 1:33] = 0
    cells[12:43, 34:66] = 0
    cells[11, 14:19] = 0
    cells[11, 48:53] = 0
    if furniture:
        for row in (18, 26, 34):
            for column in (5, 13, 21, 39, 47, 55):
                cells[row : row + 3, column : column + 3] = 100
    return cells


def test_rooms_and_corridor_are_segments_and_every_free_cell_has_one() -> None:
    cells = floor()
    found = segment(cells, 0.2, MINIMA)
    assert len(found.critical) == 2
    assert {(cell // 67, cell % 67 // 34) for cell in found.critical} == {(11, 0), (11, 1)}
    labels = found.labels
    assert ((labels > 0) == (cells == 0)).all()
    assert len(np.unique(labels[labels > 0])) == 3
    for place in (labels[1:11, 1:66], labels[12:43, 1:33], labels[12:43, 34:66]):
        values, counts = np.unique(place, return_counts=True)
        assert counts.max() / counts.sum() > 0.98, values


def test_furniture_parts_no_rooms() -> None:
    cells = floor(furniture=True)
    plain = segment(cells, 0.2, SegmentationParameters(least_wall_m=0.0))
    found = segment(cells, 0.2, MINIMA)
    assert len(plain.critical) > 10
    assert len(found.critical) == 2
    assert ((found.labels > 0) == (cells == 0)).all()


def test_with_the_constraints_only_ways_into_the_unknown_are_cut() -> None:
    cells = floor()
    cells[30:43, 1:33] = -1
    found = segment(cells, 0.2, THESIS)
    assert len(found.critical) == 1
    assert found.critical[0] // 67 == 11
    assert found.critical[0] % 67 < 34
    assert len(segment(floor(), 0.2, THESIS).critical) == 0


def test_a_window_around_the_known_part_is_enough() -> None:
    cells = np.full((80, 120), -1, dtype=np.int8)
    cells[20:64, 30:97] = floor()
    labels = segment_labels(cells, 0.2)
    assert (labels[20:64, 30:97] > 0).sum() == (cells == 0).sum()
    assert len(np.unique(labels[labels > 0])) == 3
    assert not segment_labels(np.full((5, 5), -1, dtype=np.int8), 0.2).any()


def test_the_way_to_the_unknown_goes_around_walls() -> None:
    cells = floor()
    cells[30:43, 1:33] = -1
    ways = way_to_unknown(cells == 0, cells < 0)
    assert ways[29, 10] == 0.0
    straight = np.hypot(29 - 29, 40 - 32)
    assert ways[29, 40] > straight + 20
    assert np.isinf(ways[cells == 100]).all()


def test_the_same_map_is_cut_the_same_way() -> None:
    cells = floor(furniture=True)
    one, other = segment(cells, 0.2, THESIS), segment(cells.copy(), 0.2, THESIS)
    assert one.critical == other.critical
    assert (one.labels == other.labels).all()


def test_an_unknown_criterion_is_refused() -> None:
    with pytest.raises(ValueError, match="minima, junctions, unknown"):
        SegmentationParameters(criterion="doors")
