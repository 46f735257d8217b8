"""Carriers and rovers: when they may dock, where they meet, where a rover gets off."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from simulator.docking import beside, may_dock, meeting_goals, place_beside
from simulator.fleet_client import Command
from simulator.fleet_scenario import Point, RobotType
from simulator.navigation import REACH_M, Navigation
from simulator.occupancy_grid import read_map_server
from simulator.robot import Robot
from tests.simulator.floors import TWO_ROOMS, write_floor

CARRIER = RobotType("carrier", radius_m=0.4, capacity=1, beams=36)
ROVER = RobotType("rover", radius_m=0.25, beams=36)
REACH = CARRIER.radius_m + ROVER.radius_m + REACH_M


@pytest.fixture
def navigation(tmp_path: Path) -> Navigation:
    return Navigation(read_map_server(write_floor(tmp_path, TWO_ROOMS)))


def pair(carrier: Point, rover: Point) -> tuple[Robot, Robot]:
    """Both with the command to dock with one another."""
    both = Robot("carrier", CARRIER, *carrier, 0.0), Robot("rover", ROVER, *rover, 0.0)
    for one, other in (both, both[::-1]):
        one.command, one.command_over = Command(one.id, one.id, "dock", "m", other.id), False
    return both


def test_they_dock_within_reach_of_one_another(navigation: Navigation) -> None:
    near = pair((4.0, 3.0), (4.0 + REACH, 3.0))
    assert may_dock(*near, near, navigation)
    far = pair((4.0, 3.0), (4.2 + REACH, 3.0))
    assert not may_dock(*far, far, navigation)


def test_they_do_not_dock_through_a_wall(navigation: Navigation) -> None:
    both = pair((4.3, 3.0), (5.35, 3.0))
    assert may_dock(*both, both, navigation)
    cells = navigation.grid.cells.copy()
    cells[10:60, 48:50] = 100
    navigation.learn(replace(navigation.grid, cells=cells))
    assert not may_dock(*both, both, navigation)


def test_a_full_or_busy_carrier_takes_nobody(navigation: Navigation) -> None:
    carrier, rover = pair((4.0, 3.0), (5.0, 3.0))
    rider = Robot("rider", ROVER, 4.0, 3.0, 0.0, carrier="carrier")
    assert not may_dock(carrier, rover, [carrier, rover, rider], navigation)
    carrier.activity = "undocking"
    assert not may_dock(carrier, rover, [carrier, rover], navigation)


def test_a_rover_that_rides_docks_with_no_other_carrier(navigation: Navigation) -> None:
    carrier, rover = pair((4.0, 3.0), (5.0, 3.0))
    rover.carrier, rover.command_over = "other", True
    assert not may_dock(carrier, rover, [carrier, rover], navigation)


def test_nobody_is_docked_in_the_middle_of_something_else(navigation: Navigation) -> None:
    carrier, rover = pair((4.0, 3.0), (5.0, 3.0))
    rover.command = Command("other", "rover", "explore", "target")
    assert not may_dock(carrier, rover, [carrier, rover], navigation)
    rover.command_over = True
    assert may_dock(carrier, rover, [carrier, rover], navigation)


def test_the_carrier_goes_to_the_place_and_the_rover_to_the_carrier(navigation: Navigation) -> None:
    carrier, rover = pair((4.0, 3.0), (7.0, 4.0))
    order = Command("c", "carrier", "dock", "m", "rover", path_m=((1.0, 1.0), (4.2, 3.0)))
    assert meeting_goals(carrier, rover, order, navigation) == [(4.2, 3.0)]
    goals = meeting_goals(rover, carrier, replace(order, robot="rover"), navigation)
    assert goals
    for goal in goals:
        rover.x, rover.y = goal
        assert may_dock(carrier, rover, [carrier, rover], navigation)
    # While the carrier is far from the place the rover waits there.
    carrier.x = 7.5
    assert meeting_goals(rover, carrier, replace(order, robot="rover"), navigation) == [(4.2, 3.0)]


def test_places_beside_touch_neither_carrier_nor_walls(navigation: Navigation) -> None:
    carrier, rover = pair((1.6, 1.6), (5.0, 3.0))
    places = beside(rover, carrier, navigation)
    assert places
    floor = navigation.floor(ROVER)
    for place in places:
        assert math.dist(place, carrier.position) > CARRIER.radius_m + ROVER.radius_m
        assert floor.clearance(*place, 1.0) >= ROVER.radius_m


def test_a_rover_gets_off_where_there_is_room(navigation: Navigation) -> None:
    carrier, rover = pair((4.0, 3.0), (4.0, 3.0))
    rover.carrier = "carrier"
    other = Robot("other", ROVER, 5.0, 3.0, 0.0)
    team = {"carrier": carrier, "rover": rover, "other": other}
    place = place_beside(rover, carrier, team, navigation)
    assert place is not None
    assert math.dist(place, other.position) >= 2 * ROVER.radius_m + 0.1
    crowd = {
        f"r{k}": Robot(f"r{k}", ROVER, *at, 0.0)
        for k, at in enumerate(beside(rover, carrier, navigation))
    }
    assert place_beside(rover, carrier, {**team, **crowd}, navigation) is None
