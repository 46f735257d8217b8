import math

import numpy as np

from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.detector import PoleParameters, detect_poles
from simulator.slam.experiments.drive import Disc, Laser, Surveyor
from simulator.slam.range_scan import RangeScan

LASER = Laser(beams=361, range_m=40.0, noise_m=0.02)


def scan_of(discs: list[Disc], wall: bool = False, laser: Laser = LASER) -> RangeScan:
    cells = np.zeros((800, 800), dtype=np.int8)
    if wall:
        cells[450:470, :] = 100
    surveyor = Surveyor(OccupancyGrid(cells, 0.1, (-40.0, -40.0)), discs)
    return surveyor.scan(np.zeros(3), laser, np.zeros(3), 0.0, np.random.default_rng(0))


def test_poles_are_found_where_they_stand() -> None:
    discs = [(5.0, 0.0, 0.075), (8.0, 4.0, 0.15), (3.0, -6.0, 0.2), (12.0, -5.0, 0.3)]
    found = detect_poles(scan_of(discs))
    assert len(found) == len(discs)
    for x, y, _ in discs:
        assert np.min(np.hypot(found[:, 0] - x, found[:, 1] - y)) < 0.12


def test_walls_and_what_stands_at_them_are_not_poles() -> None:
    assert len(detect_poles(scan_of([], wall=True))) == 0
    assert len(detect_poles(scan_of([(3.0, 4.8, 0.2)], wall=True))) == 0
    assert len(detect_poles(scan_of([(3.0, 2.0, 0.2)], wall=True))) == 1


def test_what_is_half_hidden_is_left_out() -> None:
    front, hidden = (4.0, 0.0, 0.4), (6.0, 0.7, 0.3)
    assert len(detect_poles(scan_of([front, hidden]))) == 1


def test_a_car_is_too_wide() -> None:
    assert len(detect_poles(scan_of([(8.0, 0.0, 1.5)]))) == 0
    wide = PoleParameters(largest_diameter_m=4.0)
    assert len(detect_poles(scan_of([(8.0, 0.0, 1.5)]), wide)) <= 1


def test_an_empty_scan_has_none() -> None:
    empty = RangeScan(0.0, np.full(181, 40.0, np.float32), 0.0, math.pi / 180, 40.0, np.zeros(3))
    assert len(detect_poles(empty)) == 0
