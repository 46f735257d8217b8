"""A small office for tests, drives through it, and the maps that SLAM makes of them."""

from functools import cache

import numpy as np

from simulator.slam.experiments.drive import Drive, Laser, OdometryNoise, Surveyor
from simulator.slam.experiments.floors import office_floor
from simulator.slam.front_end import build_map
from simulator.slam.robot_map import RobotMap

LASER = Laser(range_m=20.0)


@cache
def office_drive(floor: int, seed: int) -> Drive:
    grid, stops = office_floor(11, floor, rooms=3)
    surveyor = Surveyor(grid)
    random = np.random.default_rng(seed)
    return surveyor.drive(surveyor.path(stops), LASER, OdometryNoise(), random)


@cache
def office_map(floor: int, seed: int) -> RobotMap:
    return build_map(f"robot_{floor}_{seed}", office_drive(floor, seed).scans)


def node_truth(robot_map: RobotMap, drive: Drive) -> np.ndarray:
    """(n, 3): true poses of the nodes."""
    places = {scan.time_s: place for place, scan in enumerate(drive.scans)}
    return np.array(
        [drive.truth[places[robot_map.scans[k].time_s]] for k in sorted(robot_map.scans)]
    )
