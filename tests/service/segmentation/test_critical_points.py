"""Critical points: Thrun's minima, those beside junctions, those that lead into the unknown."""

import numpy as np

from service.coordination.segmentation.critical_points import (
    at_junctions,
    critical_points,
    local_minima,
)
from service.coordination.segmentation.graph_reduction import ReducedGraph

# A corridor 0 - 1 - 2 with a junction at 1, a doorway 3 below it to the room 4, and a narrow
# place 5 beyond 2 whose neighbours are no junctions.
GRAPH = ReducedGraph(
    (1, 7),
    {0: (1,), 1: (0, 2, 3), 2: (1, 5), 3: (1, 4), 4: (3,), 5: (2, 6), 6: (5,)},
    {0: 5.0, 1: 6.0, 2: 7.0, 3: 2.0, 4: 8.0, 5: 3.0, 6: 5.0},
)


def test_minima_are_narrower_than_all_their_neighbours() -> None:
    assert local_minima(GRAPH) == (0, 3, 5)


def test_a_critical_point_has_degree_two_and_a_junction_beside_it() -> None:
    assert at_junctions(GRAPH) == (3,)


def test_it_leads_from_known_into_unknown_space() -> None:
    into_the_room = np.array([[9.0, 8.0, 9.0, 5.0, 1.0, 9.0, 9.0]], dtype=np.float32)
    out_of_the_room = into_the_room[:, [0, 4, 2, 3, 1, 5, 6]]
    assert critical_points(GRAPH, into_the_room) == (3,)
    assert critical_points(GRAPH, out_of_the_room) == (3,)


def test_it_does_not_part_what_is_unknown_on_both_sides() -> None:
    on_both_sides = np.array([[9.0, 2.0, 9.0, 5.0, 1.0, 9.0, 9.0]], dtype=np.float32)
    assert critical_points(GRAPH, on_both_sides) == ()


def test_nothing_is_cut_where_all_is_known() -> None:
    assert critical_points(GRAPH, np.full((1, 7), np.inf, dtype=np.float32)) == ()
