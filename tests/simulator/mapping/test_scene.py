from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from simulator.mapping.scene import Box, Cup, DepthSensor, Scene, Solid, tabletop_scene

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


@dataclass(frozen=True)
class Ball:
    """A solid that the native caster does not know."""

    centre_m: tuple[float, float, float]
    radius_m: float

    def distances_m(
        self, origin_m: NDArray[np.float64], directions: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        start = origin_m - np.array(self.centre_m)
        half = directions @ start
        root = half**2 - (start @ start - self.radius_m**2)
        near = -half - np.sqrt(np.maximum(root, 0))
        return np.where((root >= 0) & (near > 0), near, np.inf)


def test_native_beams_end_where_each_solid_says() -> None:
    random = np.random.default_rng(3)
    solids: list[Solid] = [Ball((0.5, 2.0, 0.0), 0.7)]
    for _ in range(12):
        centre = tuple(random.uniform(-3, 3, 3).tolist())
        size = tuple(random.uniform(0.2, 1.5, 3).tolist())
        solids.append(Box(centre, size, float(random.uniform(0, 3))))
        solids.append(Cup(centre, size[0], size[1], closed=bool(random.integers(2))))
    directions = random.normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    distances, hit = Scene(tuple(solids)).hits((0.1, 0.0, 0.2), directions)
    each = np.array([s.distances_m(np.array([0.1, 0.0, 0.2]), directions) for s in solids])
    assert distances == pytest.approx(each.min(axis=0), abs=1e-9)
    assert (hit >= 0).sum() > 500
    seen = hit >= 0
    assert np.array_equal(np.isfinite(distances), seen)
    assert each[hit[seen], np.flatnonzero(seen)] == pytest.approx(distances[seen], abs=1e-9)
