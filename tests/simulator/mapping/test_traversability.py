import numpy as np
import pytest

from simulator.mapping.octree import OctreeMap
from simulator.mapping.scene import Box, DepthSensor, Scene, tabletop_scene
from simulator.mapping.traversability import Passage, occupancy_slice, traversability
from simulator.occupancy_grid import OccupancyGrid

LOW, TALL = Passage(height_m=0.5), Passage(height_m=1.5)


def at(grid: OccupancyGrid, x: float, y: float) -> int:
    column = int((x - grid.origin_m[0]) / grid.resolution_m)
    row = int((y - grid.origin_m[1]) / grid.resolution_m)
    return int(grid.cells[row, column])


@pytest.fixture(scope="module")
def room() -> OctreeMap:
    """A room with a table, seen from four sides, from low and from high."""
    octree = OctreeMap(0.05)
    sensor = DepthSensor(horizontal_field_rad=1.2, vertical_field_rad=1.1)
    scene = tabletop_scene(objects=3)
    for x, y, yaw in ((-2, 0, 0), (2, 0, np.pi), (0, -2, np.pi / 2), (0, 2, -np.pi / 2)):
        for z, pitch in ((0.4, 0.15), (1.3, 0.5)):
            octree.insert_scan((x, y, z), sensor.measure(scene, (x, y, z), yaw, pitch))
    return octree


def test_a_low_robot_passes_under_the_table_and_a_tall_one_does_not(room: OctreeMap) -> None:
    low, tall = traversability(room, LOW), traversability(room, TALL)
    assert at(low, 0.0, 0.0) == 0
    assert at(tall, 0.0, 0.0) == 100
    for grid in (low, tall):
        assert at(grid, -0.54, -0.34) == 100  # a leg of the table
        assert at(grid, -1.4, 0.2) == 0


def test_what_is_under_the_step_is_driven_over() -> None:
    octree = OctreeMap(0.05)
    sill = Scene((Box((0.0, 0.0, -0.05), (6.0, 6.0, 0.1)), Box((1.5, 0.0, 0.03), (0.2, 2.0, 0.06))))
    octree.insert_scan((0, 0, 1), DepthSensor().measure(sill, (0, 0, 1), 0.0, 0.6))
    assert at(traversability(octree, Passage(step_m=0.1)), 1.5, 0.0) == 0
    assert at(traversability(octree, Passage(step_m=0.0)), 1.5, 0.0) == 100


def test_a_slice_gives_probabilities_by_column() -> None:
    octree = OctreeMap(0.1)
    octree.set_log_odds([[0.05, 0.05, 0.05], [0.25, 0.05, 0.05]], [3.5, -2.0])
    grid = occupancy_slice(octree, 0.0, 0.1)
    assert grid.cells.tolist() == [[97, -1, 12]]
    assert grid.origin_m == (0.0, 0.0)


def test_an_empty_map_is_one_unknown_cell() -> None:
    assert traversability(OctreeMap(0.1), TALL).cells.tolist() == [[-1]]
    assert occupancy_slice(OctreeMap(0.1), 0.0, 1.0).cells.tolist() == [[-1]]
