"""Exploration targets in maps known in part: `.` free, `#` wall, `?` unknown."""

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.world import GridMap, RobotModel
from service.coordination.exploration.reach import ReachableSpace
from service.coordination.exploration.targets import exploration_targets, named, unknown_beside

EXPLORER = RobotModel(type="explorer", radius_m=0.25, speed_m_s=1.0, sensor_range_m=5.0)


def hall(rows: int = 12, known: int = 20, width: int = 40) -> NDArray[np.int8]:
    """A hall walled in on all sides, known up to a column."""
    cells = np.full((rows, width), 100, dtype=np.int8)
    cells[1:-1, 1:-1] = 0
    cells[:, known:] = -1
    return cells


def found_in(cells: NDArray[np.int8], robot: tuple[int, int]) -> list[tuple[int, int]]:
    grid = GridMap(cells, 0.2)
    start = robot[0] * grid.width + robot[1]
    targets = exploration_targets(grid, {"explorer": EXPLORER}, {"explorer": [start]})
    return [divmod(target.cell, grid.width) for target in targets]


def test_a_target_is_where_a_body_fits_right_before_the_unknown() -> None:
    ((row, column),) = found_in(hall(), (5, 5))
    assert row in (5, 6)
    assert 16 <= column <= 18


def test_what_robots_cannot_reach_is_no_target() -> None:
    cells = hall()
    cells[:, 10] = 100
    assert found_in(cells, (5, 5)) == []
    assert len(found_in(cells, (5, 15))) == 1


def test_a_gap_too_narrow_for_the_body_ends_the_space() -> None:
    cells = hall()
    cells[:, 10] = 100
    cells[5:7, 10] = 0
    assert found_in(cells, (5, 5)) == []
    cells[4:8, 10] = 0
    assert len(found_in(cells, (5, 5))) == 1


def test_cells_that_were_given_up_are_no_frontier() -> None:
    grid = GridMap(hall(), 0.2)
    given_up = np.ones(grid.cells.shape, dtype=np.bool_)
    targets = exploration_targets(
        grid, {"explorer": EXPLORER}, {"explorer": [5 * 40 + 5]}, given_up=given_up
    )
    assert targets == ()


def test_each_kind_of_robot_gets_the_frontiers_of_its_own_terrain() -> None:
    """Carriers stay on the left floor, rovers go on into the right one."""
    terrain = np.zeros((12, 40), dtype=np.uint8)
    terrain[:, 12:] = 1
    cells = hall()
    cells[6:, :12] = -1
    cells[:, 11] = np.where(cells[:, 11] < 0, 100, cells[:, 11])
    grid = GridMap(cells, 0.2, terrain=terrain, terrain_classes=("open", "rough"))
    carrier = RobotModel(type="carrier", radius_m=0.25, speed_m_s=1.0, enters=("open",), capacity=2)
    rover = RobotModel(type="rover", radius_m=0.25, speed_m_s=1.0, enters=("open", "rough"))
    found = exploration_targets(
        grid,
        {"rover": rover, "carrier": carrier},
        {"carrier": [3 * 40 + 4], "rover": [3 * 40 + 6]},
    )
    kinds = {target.robot_types: divmod(target.frontier_cell, 40) for target in found}
    assert set(kinds) == {("carrier",), ("rover",)}
    assert kinds["carrier",][1] < 12 <= kinds["rover",][1]


def test_a_frontier_that_moved_a_little_keeps_its_name() -> None:
    before, after = hall(known=20), hall(known=24)
    (old,) = exploration_targets(
        GridMap(before, 0.2), {"explorer": EXPLORER}, {"explorer": [5 * 40 + 5]}
    )
    first = named([old], GridMap(before, 0.2), {}, next_number=7, same_within_m=3.0)
    assert list(first) == ["frontier 7"]
    known = {"frontier 7": tuple(GridMap(before, 0.2).centres_m([old.cell])[0].tolist())}
    (new,) = exploration_targets(
        GridMap(after, 0.2), {"explorer": EXPLORER}, {"explorer": [5 * 40 + 5]}
    )
    assert list(named([new], GridMap(after, 0.2), known, next_number=8, same_within_m=3.0)) == [
        "frontier 7"
    ]
    assert list(named([new], GridMap(after, 0.2), known, next_number=8, same_within_m=0.3)) == [
        "frontier 8"
    ]


def test_unknown_cells_around_a_target_are_those_next_to_free_ones() -> None:
    grid = GridMap(hall(), 0.2)
    cells = unknown_beside(grid, 5 * 40 + 19, 3)
    assert set(cells % 40) == {20}
    assert set(cells // 40) == {2, 3, 4, 5, 6, 7, 8}


def test_lengths_are_the_same_from_robots_and_from_targets() -> None:
    grid = GridMap(hall(known=40), 0.2)
    space = ReachableSpace(grid, EXPLORER)
    robots, targets = [3 * 40 + 3, 8 * 40 + 30, 5 * 40 + 12], [6 * 40 + 20, 4 * 40 + 35]
    forth = space.lengths_m(robots, targets)
    back = space.lengths_m(targets, robots)
    assert np.allclose(forth, back.T)
    way = space.way(robots[0], targets[0])
    assert (way[0], way[-1]) == (robots[0], targets[0])
    apart = np.stack(np.divmod(way, 40), axis=1)
    steps = np.linalg.norm(np.diff(apart, axis=0), axis=1)
    assert abs(float(steps.sum()) * 0.2 - forth[0, 0]) < 0.01 * forth[0, 0]
