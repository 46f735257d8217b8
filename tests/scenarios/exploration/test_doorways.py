"""Doorways found against doorways labelled."""

import numpy as np

from scenarios.exploration.buildings import generated, rooms_between
from scenarios.exploration.doorways import Score, score
from service.coordination.segmentation.segmentation import SegmentationParameters


def test_doorways_of_a_drawn_office_are_found() -> None:
    building = generated("small_rooms", 2)
    found = score(building.truth.cells, 0.2, building.doorways_m, SegmentationParameters())
    assert found.doorways == len(building.doorways_m)
    assert found.recall > 0.9
    assert found.precision > 0.9


def test_scores_add_up_and_know_empty_sets() -> None:
    total = Score(3, 4, 5, 10) + Score(1, 4, 1, 2)
    assert (total.recall, total.precision) == (0.5, 0.5)
    assert (Score().recall, Score().precision) == (1.0, 1.0)


def test_doorways_that_nobody_has_seen_do_not_count() -> None:
    building = generated("small_rooms", 2)
    cells = building.truth.cells.copy()
    cells[:, 60:] = -1
    found = score(cells, 0.2, building.doorways_m, SegmentationParameters())
    assert 0 < found.doorways < len(building.doorways_m)


def test_shut_doorways_part_the_rooms() -> None:
    building = generated("small_rooms", 2)
    free = building.truth.cells == 0
    rooms = rooms_between(free, 0.2, building.doorways_m)
    assert len(np.unique(rooms[free])) >= building.rooms.max()  # type: ignore[union-attr]
    assert ((rooms > 0) == free).all()
