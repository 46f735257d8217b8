"""Frontiers on drawn floors: `.` known free, `#` wall, `?` unknown."""

import numpy as np
from numpy.typing import NDArray

from service.coordination.frontiers import frontiers


def drawn(text: str) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    cells = np.array([list(line) for line in text.split()])
    return cells == ".", cells == "?"


def test_an_explored_floor_has_no_frontier() -> None:
    assert frontiers(*drawn("##### #...# #####"), visible_cells=5.0) == ()


def test_a_frontier_stands_for_its_cells_and_lies_in_their_middle() -> None:
    (frontier,) = frontiers(*drawn("######? #.....? #.....? #.....? ######?"), visible_cells=2.0)
    assert (frontier.cell, frontier.cells) == ((2, 5), 3)


def test_frontiers_that_see_one_another_are_one_target() -> None:
    floor = drawn("?#########? ?.........? ?.........? ###########")
    assert len(frontiers(*floor, visible_cells=20.0)) == 1
    assert len(frontiers(*floor, visible_cells=4.0)) == 2


def test_a_wall_between_keeps_them_apart() -> None:
    floor = drawn("??#?? ..#.. ..#.. ..... #####")
    assert len(frontiers(*floor, visible_cells=20.0)) == 2


def test_components_that_are_not_connected_are_never_joined() -> None:
    found = frontiers(*drawn("??#?? ..#.. ..#.. #####"), visible_cells=20.0)
    assert [f.component for f in found] == [1, 2]


def test_single_cells_are_left_out() -> None:
    assert frontiers(*drawn("#?# #.# #.# ###"), visible_cells=5.0) == ()
