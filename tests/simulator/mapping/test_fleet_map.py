from dataclasses import dataclass

import numpy as np
import pytest

from simulator.mapping.fleet_map import HEADER, FleetMap, resampled, scan_message
from simulator.mapping.octree import MapFullError
from simulator.mapping.scene import DepthSensor, tabletop_scene
from simulator.occupancy_grid import OccupancyGrid


@dataclass
class Cells:
    origin_m: tuple[float, float]
    resolution_m: float
    width: int
    height: int


ROOM = Cells((-3.0, -3.0), 0.1, 60, 60)


def scanned(limit_bytes: int = 10**8) -> FleetMap:
    fleet_map = FleetMap(0.05, limit_bytes, None)
    sensor = DepthSensor(horizontal_field_rad=1.2, vertical_field_rad=1.1)
    for x, y, yaw in ((-2, 0, 0), (2, 0, np.pi), (0, -2, np.pi / 2), (0, 2, -np.pi / 2)):
        for z, pitch in ((0.4, 0.15), (1.3, 0.5)):
            points = sensor.measure(tabletop_scene(), (x, y, z), yaw, pitch)
            fleet_map.insert((x, y, z), points, None)
    return fleet_map


def test_robots_of_unlike_height_get_unlike_maps_of_one_octree() -> None:
    fleet_map = scanned()
    low = fleet_map.passage(ROOM, 0.0, 0.1, 0.5)
    tall = fleet_map.passage(ROOM, 0.0, 0.1, 1.5)
    assert low.shape == tall.shape == (60, 60)
    assert low[30, 30] == 0  # under the middle of the table
    assert tall[30, 30] == 100
    assert (tall >= low)[(low >= 0) & (tall >= 0)].all()
    top = fleet_map.band(ROOM, 0.70, 0.80)
    assert top[30, 30] > 60
    assert top[30, 5] < 50


def test_a_map_goes_on_from_its_file() -> None:
    fleet_map = scanned()
    contents = fleet_map.to_bytes(".ot")
    again = FleetMap(0.05, 10**8, contents)
    assert again.to_bytes(".ot") == contents
    with pytest.raises(MapFullError):
        scanned(limit_bytes=100_000)


def test_a_cell_is_as_occupied_as_the_worst_of_its_columns() -> None:
    fine = OccupancyGrid(np.array([[0, 100, -1, -1], [-1, 0, -1, 0]], dtype=np.int8), 0.1, (0.1, 0))
    coarse = resampled(fine, Cells((0.1, 0.0), 0.2, 3, 1))
    assert coarse.tolist() == [[100, 0, -1]]
    assert resampled(fine, Cells((9.0, 9.0), 0.2, 2, 2)).tolist() == [[-1, -1], [-1, -1]]


def test_beams_take_six_bytes_unless_they_are_very_long() -> None:
    points = np.random.default_rng(0).uniform(-20, 20, (1000, 3))
    assert len(scan_message((1.0, 2.0, 3.0), points)) == HEADER.size + 6 * 1000
    assert len(scan_message((1.0, 2.0, 3.0), points + 500)) == HEADER.size + 12 * 1000
