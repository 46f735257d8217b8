import numpy as np
import pytest

from simulator.mapping.scene import Box, Cup, DepthSensor, Scene, tabletop_scene

RIGHT, DOWN = np.array([[1.0, 0.0, 0.0]]), np.array([[0.0, 0.0, -1.0]])


def test_a_beam_ends_on_the_near_face_of_a_box() -> None:
    box = Box((3.0, 0.0, 0.0), (2.0, 1.0, 1.0))
    assert box.distances_m(np.zeros(3), RIGHT) == pytest.approx([2.0])
    assert box.distances_m(np.array([0.0, 0.6, 0.0]), RIGHT) == pytest.approx([np.inf])
    turned = Box((3.0, 0.0, 0.0), (2.0, 1.0, 1.0), yaw_rad=np.pi / 2)
    assert turned.distances_m(np.zeros(3), RIGHT) == pytest.approx([2.5])


def test_a_cup_is_open_at_the_top_and_a_can_is_not() -> None:
    cup, can = Cup((1.0, 0.0, 0.0), 0.1, 0.2), Cup((1.0, 0.0, 0.0), 0.1, 0.2, closed=True)
    above = np.array([1.0, 0.0, 1.0])
    assert cup.distances_m(above, DOWN) == pytest.approx([1.0])
    assert can.distances_m(above, DOWN) == pytest.approx([0.8])
    assert cup.distances_m(np.array([0.0, 0.0, 0.1]), RIGHT) == pytest.approx([0.9])
    assert cup.distances_m(np.array([0.0, 0.0, 0.3]), RIGHT) == pytest.approx([np.inf])


def test_the_sensor_sees_the_nearest_surface_within_range() -> None:
    scene = Scene((Box((2.0, 0.0, 0.0), (0.2, 1.0, 1.0)), Box((4.0, 0.0, 0.0), (0.2, 9.0, 9.0))))
    sensor = DepthSensor(columns=21, rows=21, range_m=3.0)
    points = sensor.measure(scene, (0.0, 0.0, 0.0), yaw_rad=0.0, pitch_rad=0.0)
    assert points[:, 0] == pytest.approx(1.9)
    assert len(sensor.measure(scene, (0.0, 0.0, 0.0), yaw_rad=np.pi, pitch_rad=0.0)) == 0


def test_looking_down_shows_the_table() -> None:
    points = DepthSensor().measure(tabletop_scene(), (-1.5, 0.0, 1.4), yaw_rad=0.0, pitch_rad=0.5)
    on_table = np.abs(points[:, 2] - 0.75) < 1e-5
    assert on_table.sum() > 1000
    assert (points[:, 2] > 0.76).sum() > 500
