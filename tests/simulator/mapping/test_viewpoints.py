import numpy as np
import pytest

from simulator.mapping.viewpoints import Platform, Ways, look_around, look_at, sample_viewpoints
from simulator.occupancy_grid import OccupancyGrid


def hall() -> OccupancyGrid:
    """A hall of 8 x 6 m with a wall across it that leaves a gap of 1 m at the top."""
    cells = np.zeros((60, 80), dtype=np.int8)
    cells[0], cells[-1], cells[:, 0], cells[:, -1] = 100, 100, 100, 100
    cells[:48, 40] = 100
    return OccupancyGrid(cells, 0.1, (0.0, 0.0))


def test_the_way_leads_through_the_gap() -> None:
    ways = Ways(hall(), Platform(radius_m=0.3, speed_m_s=0.5), (2.0, 1.0))
    around = 2 * np.hypot(2.05, 4.3)  # past the wall's upper end, and back down
    assert ways.travel_time_s((6.1, 1.0)) == pytest.approx(around / 0.5, rel=0.1)
    assert ways.travel_time_s((2.0, 3.0)) == pytest.approx(4.0, rel=0.05)
    assert ways.travel_time_s((2.0, 1.0)) == 0.0
    stout = Ways(hall(), Platform(radius_m=0.7), (2.0, 1.0))
    assert stout.travel_time_s((6.1, 1.0)) == np.inf


def test_the_floor_hidden_under_the_robot_is_no_wall() -> None:
    grid = hall()
    grid.cells[5:15, 15:25] = -1
    ways = Ways(grid, Platform(radius_m=0.5), (2.0, 1.0))
    assert np.isfinite(ways.travel_time_s((2.0, 3.0)))
    assert not ways.stands_free((4.05, 1.0))


def test_samples_stand_free_near_the_target_and_look_at_it() -> None:
    ways = Ways(hall(), Platform(radius_m=0.3, sensor_height_m=1.3), (2.0, 1.0))
    target = (3.0, 3.0, 0.8)
    found = sample_viewpoints(ways, target, 1.5, 30, np.random.default_rng(0))
    assert len(found) == 30
    for viewpoint in found:
        x, y, z = viewpoint.position_m
        distance_m = np.hypot(x - 3.0, y - 3.0)
        assert distance_m <= 1.5
        assert x < 3.75
        assert z == 1.3
        axis = np.array([np.cos(viewpoint.yaw_rad), np.sin(viewpoint.yaw_rad)])
        assert np.array([x, y]) + distance_m * axis == pytest.approx(np.array([3.0, 3.0]))
        assert np.tan(viewpoint.pitch_rad) * distance_m == pytest.approx(0.5)
    nowhere = sample_viewpoints(ways, (4.05, 1.0, 0.8), 0.2, 5, np.random.default_rng(0))
    assert nowhere == []


def test_looking_around_turns_through_a_full_circle() -> None:
    views = look_around((1.0, 2.0), 1.3, views=4, pitches_rad=(0.1, 0.5))
    assert len(views) == 8
    assert [view.yaw_rad for view in views[:4]] == pytest.approx([0, np.pi / 2, np.pi, 1.5 * np.pi])
    assert look_at((0.0, 0.0), 1.0, (1.0, 0.0, 0.0)).pitch_rad == pytest.approx(np.pi / 4)
