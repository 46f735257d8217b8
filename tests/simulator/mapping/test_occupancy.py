"""Robots map a floor together: what they drove past is free, walls are walls, the rest unknown."""

from pathlib import Path

import numpy as np

from simulator.mapping.occupancy import JointOccupancyMap
from simulator.navigation import Navigation
from simulator.occupancy_grid import read_map_server
from simulator.robot import Robot
from simulator.sensors import RangeFinder
from tests.simulator.floors import EXPLORER, TWO_ROOMS, write_floor


def test_two_robots_map_two_rooms(tmp_path: Path) -> None:
    truth = read_map_server(write_floor(tmp_path, TWO_ROOMS))
    finder = RangeFinder(Navigation(truth).walls)
    joint = JointOccupancyMap(truth.cells.shape, truth.resolution_m, truth.origin_m)
    random = np.random.default_rng(0)
    assert (joint.grid().cells == -1).all()
    for x in np.arange(2.0, 7.0, 0.5):
        left = Robot("left", EXPLORER, float(x), 3.5, 0.1)
        joint.insert(finder.scan(left, [], (), 0.0, random))
    half = joint.grid().cells
    assert (half[:, 150:] == -1).all()
    for x in np.arange(12.0, 18.0, 0.5):
        right = Robot("right", EXPLORER, float(x), 3.5, 0.1)
        joint.insert(finder.scan(right, [], (), 0.0, random))
    cells = joint.grid().cells
    known = cells >= 0
    wrong = known & ((cells >= 50) != (truth.cells == 100))
    assert known.mean() > 0.6
    assert wrong.sum() / known.sum() < 0.01
