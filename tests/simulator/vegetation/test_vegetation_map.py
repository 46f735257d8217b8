import numpy as np
import pytest

from simulator.vegetation.vegetation_map import VegetationMap, VegetationMapParameters

POINT = np.array([[0.55, 0.25, 0.05]])
SENSOR = np.array([0.0, 0.0, 0.6])


def combined(probabilities: list[float], prior: float) -> float:
    """Eq. 6.18, measurement by measurement."""
    estimate = prior
    for p in probabilities:
        odds = (1 - p) / p * (1 - estimate) / estimate * prior / (1 - prior)
        estimate = 1 / (1 + odds)
    return estimate


@pytest.mark.parametrize("prior", [0.5, 0.2])
@pytest.mark.parametrize("measured", [[0.7], [0.7, 0.8, 0.3], [0.2, 0.1, 0.6, 0.4]])
def test_measurements_combine_as_in_equation_6_18(measured: list[float], prior: float) -> None:
    vegetation_map = VegetationMap(VegetationMapParameters(prior=prior))
    for p in measured:
        vegetation_map.insert(POINT, SENSOR, np.array([p]))
    found = float(vegetation_map.probability(POINT)[0])
    assert found == pytest.approx(combined(measured, prior), abs=0.03)


def test_the_order_of_measurements_does_not_matter() -> None:
    one, other = VegetationMap(), VegetationMap()
    for p, q in zip((0.6, 0.9, 0.2), (0.2, 0.6, 0.9), strict=True):
        one.insert(POINT, SENSOR, np.array([p]))
        other.insert(POINT, SENSOR, np.array([q]))
    assert one.probability(POINT)[0] == pytest.approx(other.probability(POINT)[0], abs=1e-9)


def test_a_map_can_change_its_mind() -> None:
    vegetation_map = VegetationMap()
    for _ in range(50):
        vegetation_map.insert(POINT, SENSOR, np.array([1.0]))
    assert vegetation_map.probability(POINT)[0] < 0.998
    for _ in range(5):
        vegetation_map.insert(POINT, SENSOR, np.array([0.0]))
    assert vegetation_map.probability(POINT)[0] < 0.5


def test_unclassified_measurements_only_say_occupied() -> None:
    vegetation_map = VegetationMap()
    vegetation_map.insert(POINT, SENSOR, np.array([np.nan]))
    assert np.isnan(vegetation_map.probability(POINT)).all()
    assert vegetation_map.octree.log_odds(POINT)[0] > 0


def test_a_moving_scanner_frees_space_from_where_it_was() -> None:
    points = np.array([[1.05, 0.05, 0.05], [1.05, 0.95, 0.05]])
    sensors = np.array([[0.05, 0.05, 0.05], [0.05, 0.95, 0.05]])
    vegetation_map = VegetationMap()
    vegetation_map.insert(points, sensors, np.array([0.5, 0.5]))
    between = np.array([[0.55, 0.05, 0.05], [0.55, 0.95, 0.05], [0.55, 0.5, 0.05]])
    known = ~np.isnan(vegetation_map.octree.log_odds(between))
    assert known.tolist() == [True, True, False]


def test_the_surface_is_what_beams_ended_at() -> None:
    vegetation_map = VegetationMap()
    vegetation_map.insert(POINT, SENSOR, np.array([0.9]))
    centres, evidence, occupied = vegetation_map.surface()
    assert occupied.all()
    assert centres == pytest.approx(POINT)
    assert evidence[0] > 2


def test_ground_that_grazing_beams_pass_stays_surface() -> None:
    vegetation_map = VegetationMap()
    vegetation_map.insert(POINT, SENSOR, np.array([0.9]))
    beyond = np.array([[2.05, 0.25, 0.05]])
    for _ in range(5):
        vegetation_map.insert(beyond, np.array([0.05, 0.25, 0.05]), np.array([0.1]))
    centres, evidence, occupied = vegetation_map.surface()
    first = np.linalg.norm(centres - POINT, axis=1).argmin()
    assert centres[first] == pytest.approx(POINT[0])
    assert evidence[first] > 2
    assert not occupied[first]
