"""Trees are grown for few sources, kept while the map stays, and repaired where it changes."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

from semantic_attachments.path_costs import PathCosts
from semantic_attachments.world import Blockade, GridMap, Location, RobotModel, World

GRID = GridMap(np.zeros((60, 100), np.int8), resolution_m=0.2)
PLACES = {
    "south_west": Location((2.1, 2.1)),
    "north_west": Location((2.1, 10.1)),
    "north": Location((9.9, 10.3)),
    "south": Location((10.1, 1.9)),
    "north_east": Location((18.1, 10.1)),
    "south_east": Location((18.1, 2.1)),
}
ROBOT = RobotModel("robot", radius_m=0.3, speed_m_s=0.5)
BEFORE = World(GRID, PLACES, {"robot": ROBOT})


def calls(world: World) -> list[tuple[str, str, str]]:
    return [("robot", start, goal) for start, goal in permutations(world.locations, 2)]


def with_rubble(*segment_m: tuple[float, float], at: bool = True) -> World:
    rubble = Blockade("rubble", (segment_m[0], segment_m[1]), 30.0)
    there = {"rubble": Location(rubble.centre_m, blockade="rubble")} if at else {}
    return replace(BEFORE, locations={**PLACES, **there}, blockades={"rubble": rubble}, version=1)


def test_a_vertex_cover_of_the_pairs_is_grown() -> None:
    costs = PathCosts(BEFORE)
    costs.many([("robot", "south_west", goal) for goal in PLACES])
    assert costs.statistics.fields == 1
    costs.many(calls(BEFORE))
    assert costs.statistics.fields == 5


@pytest.mark.parametrize(
    ("rubble", "grown"),
    [
        # A post on the straight way south: a detour of a few cells behind it.
        (with_rubble((6.1, 2.0), (6.1, 2.2), at=False), 0),
        (with_rubble((6.1, 2.0), (6.1, 2.2)), 1),
    ],
)
def test_trees_that_a_small_blockade_touches_are_repaired(rubble: World, grown: int) -> None:
    before = PathCosts(BEFORE)
    before.many(calls(BEFORE))
    after = before.after(rubble)
    assert after.many(calls(rubble)) == pytest.approx(PathCosts(rubble).many(calls(rubble)))
    done = after.statistics
    assert done.fields == grown
    assert done.forgotten > 0
    assert done.repaired > 0
    assert 0 < done.cells_repaired < 0.1 * GRID.cells.size * done.repaired
    back = after.after(replace(BEFORE, version=2))
    assert back.many(calls(BEFORE)) == pytest.approx(before.many(calls(BEFORE)))


def test_a_wall_across_the_map_is_no_small_change() -> None:
    before = PathCosts(BEFORE)
    before.many(calls(BEFORE))
    split = with_rubble((6.1, -1.0), (6.1, 13.0))
    after = before.after(split)
    assert after.many(calls(split)) == pytest.approx(PathCosts(split).many(calls(split)))
    assert after.statistics.fields > 1


def test_a_robot_inside_the_blockade_it_goes_to_gets_a_tree_of_its_own() -> None:
    world = with_rubble((9.9, 9.0), (9.9, 11.0))
    costs = PathCosts(world)
    assert costs("robot", "north", "rubble") < 2.0
    assert costs("robot", "north", "south_west") == pytest.approx(
        costs("robot", "south_west", "north")
    )
    assert costs("robot", "rubble", "south") == pytest.approx(costs("robot", "south", "rubble"))
