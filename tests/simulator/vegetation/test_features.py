import numpy as np
import pytest

from simulator.vegetation.features import Measurements, incidence_angles, measure, surface_normals


def plane(normal: np.ndarray, random: np.random.Generator, count: int = 400) -> np.ndarray:
    """Points of a plane through (0, 0, -1), with a millimetre of noise."""
    normal = normal / np.linalg.norm(normal)
    across = np.cross(normal, [0.3, 1.0, 0.2])
    across /= np.linalg.norm(across)
    basis = np.stack([across, np.cross(normal, across)])
    flat = random.uniform(-1, 1, (count, 2)) @ basis
    return flat + [0, 0, -1] + random.normal(0, 0.001, (count, 1)) * normal


@pytest.mark.parametrize("normal", [[0, 0, 1], [0.3, -0.2, 1], [1, 0.2, 0.1]])
def test_normals_of_a_plane(normal: list[float]) -> None:
    points = plane(np.array(normal, float), np.random.default_rng(1))
    found = surface_normals(points, 20)
    cosine = np.abs(found @ (np.array(normal) / np.linalg.norm(normal)))
    assert cosine.min() > np.cos(np.radians(2))


def test_few_points_count_as_level_ground() -> None:
    assert surface_normals(np.array([[1.0, 0, 0], [2.0, 0, 0]])).tolist() == [[0, 0, 1]] * 2


def test_incidence_on_level_ground_follows_from_height_and_range() -> None:
    """On level ground the cosine of the incidence angle is height over range."""
    points = np.array([[1.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    sensor = np.array([0.0, 0.0, 0.6])
    angles = incidence_angles(points, np.tile([0.0, 0, -1], (3, 1)), sensor)
    ranges = np.linalg.norm(points - sensor, axis=1)
    assert np.allclose(np.cos(angles), 0.6 / ranges)


def test_measure_turns_with_the_scan() -> None:
    """Features do not depend on where and in which direction a scan was made."""
    random = np.random.default_rng(2)
    points = plane(np.array([0.1, 0.0, 1.0]), random)
    remission = random.uniform(0, 100, len(points))
    sensor = np.array([0.3, -0.2, 0.1])
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    shift = np.array([5.0, 7.0, 0.5])
    here = measure(points, remission, sensor).features()
    there = measure(points @ turn.T + shift, remission, turn @ sensor + shift).features()
    assert np.allclose(here, there, atol=1e-6)


def test_a_moving_scanner_has_a_position_for_each_point() -> None:
    points = plane(np.array([0.0, 0.0, 1.0]), np.random.default_rng(3))
    sensors = points + np.array([0.0, 0.0, 0.7])
    found = measure(points, np.zeros(len(points)), sensors)
    assert np.allclose(found.range_m, 0.7)
    assert np.degrees(found.incidence_rad).max() < 3


def test_measurements_are_chosen_and_joined() -> None:
    measured = Measurements(np.array([1.0, 2.0]), np.array([0.1, 0.2]), np.array([5.0, 6.0]))
    both = Measurements.joined([measured[np.array([False, True])], measured])
    assert len(both) == 3
    assert both.features()[0].tolist() == [2.0, 0.2, 6.0]
