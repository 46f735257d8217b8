from pathlib import Path

import numpy as np
import pytest

from simulator.fleet_scenario import HiddenBlockade, RobotType
from simulator.navigation import Navigation
from simulator.occupancy_grid import read_map_server
from simulator.robot import Robot
from simulator.sensors import RangeFinder, Scan
from tests.simulator.floors import TWO_ROOMS, write_floor

LASER = RobotType("scout", sensor_range_m=6.0, beams=360)
BLOCKADE = HiddenBlockade("blockade_1", ((9.5, 3.0), (9.5, 4.0)), 5.0)


@pytest.fixture
def walls(tmp_path: Path) -> RangeFinder:
    return RangeFinder(Navigation(read_map_server(write_floor(tmp_path, TWO_ROOMS))).walls)


def scan(finder: RangeFinder, x: float, *others: Robot, heading_rad: float = 0.0) -> Scan:
    robot = Robot("r", LASER, x, 3.5, heading_rad)
    return finder.scan(robot, [robot, *others], [BLOCKADE], 0.0, np.random.default_rng(0))


def test_beams_end_at_walls_blockades_and_robots(walls: RangeFinder) -> None:
    seen = scan(walls, 5.0)
    assert seen.ranges_m[0] == pytest.approx(4.5, abs=0.02)
    assert seen.ranges_m[90] == pytest.approx(2.5, abs=0.02)
    assert seen.ranges_m[180] == pytest.approx(4.0, abs=0.02)
    assert seen.blockades == ("blockade_1",)
    other = Robot("other", LASER, 7.0, 3.5, 0.0)
    hidden = scan(walls, 5.0, other)
    assert hidden.ranges_m[0] == pytest.approx(2.0 - LASER.radius_m, abs=0.02)


def test_what_is_out_of_range_or_behind_a_wall_is_not_sensed(walls: RangeFinder) -> None:
    assert scan(walls, 3.0).blockades == ()
    assert scan(walls, 3.0).ranges_m[0] == pytest.approx(6.0)
    robot = Robot("r", LASER, 8.0, 1.5, 0.0)
    beyond = HiddenBlockade("beyond", ((10.5, 1.2), (10.5, 1.8)), 5.0)
    seen = walls.scan(robot, [robot], [beyond], 0.0, np.random.default_rng(0))
    assert seen.blockades == ()


def test_the_first_beam_looks_ahead(walls: RangeFinder) -> None:
    turned = scan(walls, 5.0, heading_rad=np.pi / 2)
    assert turned.ranges_m[0] == pytest.approx(2.5, abs=0.02)


def test_noise_repeats_with_its_seed(walls: RangeFinder) -> None:
    noisy = RangeFinder(walls.floor, noise_m=0.05)
    first, second, clean = scan(noisy, 5.0), scan(noisy, 5.0), scan(walls, 5.0)
    assert np.array_equal(first.ranges_m, second.ranges_m)
    assert 0.01 < np.abs(first.ranges_m - clean.ranges_m).mean() < 0.1
