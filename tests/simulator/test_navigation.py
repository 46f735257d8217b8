"""Routes, acceptance of the service's paths, reach, and the point a robot steers to."""

import itertools
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from simulator.fleet_scenario import MARGIN_M, HiddenBlockade, Point
from simulator.navigation import REACH_M, Navigation
from simulator.occupancy_grid import OccupancyGrid, read_map_server
from simulator.robot import Robot
from tests.simulator.floors import EXPLORER, TWO_ROOMS, write_floor

GAP = HiddenBlockade("gap", ((9.5, 3.0), (9.5, 4.0)), 5.0)


@pytest.fixture
def navigation(tmp_path: Path) -> Navigation:
    return Navigation(read_map_server(write_floor(tmp_path, TWO_ROOMS)))


def robot_at(x: float, y: float) -> Robot:
    return Robot("robot", EXPLORER, x, y, 0.0)


def test_a_route_leads_through_the_gap_to_the_nearest_goal(navigation: Navigation) -> None:
    robot = robot_at(3.0, 2.0)
    route = navigation.route(robot, [(16.0, 5.0), (12.0, 2.0)])
    assert route is not None
    assert route[0] == robot.position
    assert route[-1] == (12.0, 2.0)
    assert any(9.0 <= x <= 10.0 and 3.3 <= y <= 3.7 for x, y in densely(route))


@pytest.mark.parametrize("seed", range(8))
def test_routes_keep_their_distance(navigation: Navigation, seed: int) -> None:
    random = np.random.default_rng(seed)
    robot = robot_at(*random.uniform([1.5, 1.5], [8.0, 5.0]))
    goal = tuple(random.uniform([11.0, 1.5], [18.0, 5.5]))
    route = navigation.route(robot, [(goal[0], goal[1])])
    assert route is not None
    floor, least_m = navigation.floor(EXPLORER), EXPLORER.radius_m + MARGIN_M
    assert all(floor.clearance(x, y, 1.0) >= least_m - 0.02 for x, y in densely(route))


def test_a_known_blockade_closes_the_only_way_until_it_is_gone(navigation: Navigation) -> None:
    robot, goals = robot_at(3.0, 2.0), [(12.0, 2.0)]
    navigation.known["gap"] = GAP
    assert navigation.route(robot, goals) is None
    assert navigation.is_blocked([(8.0, 3.5), (11.0, 3.5)], 0.3)
    assert not navigation.is_blocked([(8.0, 3.5), (9.0, 3.5)], 0.3)
    navigation.known.pop("gap")
    assert navigation.route(robot, goals) is not None


def test_a_dead_robot_in_the_gap_closes_it_for_others_but_not_for_itself(
    navigation: Navigation,
) -> None:
    navigation.standing.append((9.5, 3.5, 0.3))
    assert navigation.route(robot_at(3.0, 2.0), [(12.0, 2.0)]) is None
    assert navigation.standing_but(robot_at(9.5, 3.5)) == []


def test_a_path_is_accepted_if_the_body_fits_along_it(navigation: Navigation) -> None:
    robot = robot_at(3.0, 2.0)
    around = ((3.0, 2.0), (8.5, 3.5), (11.0, 3.5))
    assert navigation.accepts(robot, around)
    assert not navigation.accepts(robot, ((3.0, 2.0), (12.0, 2.0)))
    assert not navigation.accepts(robot, ((6.0, 2.0), *around[1:]))
    assert not navigation.accepts(robot, around[:1])
    navigation.known["gap"] = GAP
    assert not navigation.accepts(robot, around)
    navigation.known.clear()
    navigation.standing.append((6.0, 2.8, 0.3))
    assert not navigation.accepts(robot, around)


def test_a_wide_robot_does_not_fit_where_a_slim_one_does(navigation: Navigation) -> None:
    wide = Robot("wide", replace(EXPLORER, radius_m=0.6), 3.0, 2.0, 0.0)
    assert navigation.route(wide, [(12.0, 2.0)]) is None
    assert navigation.route(robot_at(3.0, 2.0), [(12.0, 2.0)]) is not None


def test_a_blockade_is_reached_from_near_by_and_not_through_a_wall(navigation: Navigation) -> None:
    far_m = EXPLORER.radius_m + REACH_M
    assert navigation.reaches(robot_at(9.5 - far_m, 3.5), GAP)
    assert not navigation.reaches(robot_at(9.5 - far_m - 0.2, 3.5), GAP)
    # As near as that, with a wall between.
    cells = navigation.grid.cells.copy()
    cells[10:60, 48:50] = 100
    navigation.learn(replace(navigation.grid, cells=cells))
    assert not navigation.reaches(
        robot_at(4.4, 3.0), HiddenBlockade("b", ((5.1, 2.0), (5.1, 4.0)), 5.0)
    )


def test_approaches_are_places_from_which_it_is_reached(navigation: Navigation) -> None:
    navigation.known["gap"] = GAP
    places = navigation.approaches(robot_at(3.0, 2.0), GAP)
    assert places
    assert all(navigation.reaches(robot_at(*place), GAP) for place in places)


def test_forbidden_terrain_is_for_those_who_may_enter_it(tmp_path: Path) -> None:
    grid = read_map_server(write_floor(tmp_path, TWO_ROOMS))
    terrain = np.zeros(grid.cells.shape, dtype=np.uint8)
    terrain[:, 100:] = 1
    mixed = OccupancyGrid(grid.cells, grid.resolution_m, grid.origin_m, terrain, ("open", "rough"))
    navigation = Navigation(mixed)
    careful = Robot("careful", replace(EXPLORER, enters=("open",)), 3.0, 2.0, 0.0)
    tough = Robot("tough", replace(EXPLORER, enters=("open", "rough")), 3.0, 2.0, 0.0)
    assert navigation.route(careful, [(12.0, 2.0)]) is None
    assert navigation.route(tough, [(12.0, 2.0)]) is not None
    assert navigation.floor(tough.kind) is navigation.walls


def test_a_learned_map_replaces_the_old_one(navigation: Navigation) -> None:
    closed = navigation.grid.cells.copy()
    closed[:, 92:97] = 100
    old = navigation.grid
    before = navigation.copy()
    navigation.learn(OccupancyGrid(closed, old.resolution_m, old.origin_m))
    assert navigation.route(robot_at(3.0, 2.0), [(12.0, 2.0)]) is None
    assert before.route(robot_at(3.0, 2.0), [(12.0, 2.0)]) is not None


def test_the_carrot_lies_ahead_on_the_route_and_in_plain_reach(navigation: Navigation) -> None:
    robot = robot_at(3.0, 3.5)
    robot.follow([(3.0, 3.5), (6.0, 3.5), (6.0, 5.0)])
    point, left_m = navigation.carrot(robot)
    assert point == pytest.approx((3.5, 3.5))
    assert left_m == pytest.approx(math.dist((3.0, 3.5), (6.0, 5.0)))
    robot.x, robot.y = 5.8, 3.5
    point, _ = navigation.carrot(robot)
    assert point == pytest.approx((6.0, 3.8))
    robot.x, robot.y = 6.01, 4.9
    point, left_m = navigation.carrot(robot)
    assert point == (6.0, 5.0)
    assert left_m == pytest.approx(0.1, abs=0.01)
    assert robot.leg == 1


def test_a_loop_of_the_route_is_left_out(navigation: Navigation) -> None:
    robot = robot_at(3.0, 3.51)
    robot.follow([(3.35, 3.31), (3.4, 3.5), (3.2, 3.5), (3.0, 3.5), (2.0, 3.5)])
    point, _ = navigation.carrot(robot)
    assert point == pytest.approx((2.5, 3.5))


def densely(route: list[Point]) -> list[Point]:
    points = []
    for (ax, ay), (bx, by) in itertools.pairwise(route):
        for share in np.linspace(0.0, 1.0, 40):
            points.append((ax + share * (bx - ax), ay + share * (by - ay)))
    return points
