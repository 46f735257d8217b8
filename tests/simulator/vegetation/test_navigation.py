import numpy as np
import pytest

from simulator.vegetation.navigation import NavigationParameters, NavigationRecord, navigate
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.terrain_world import TerrainWorld
from tests.simulator.vegetation.models import small_model

TILTING = SensorSetup("LMS 291-S05", 0.6, (float(np.deg2rad(8)), float(np.deg2rad(30))))
QUICK = NavigationParameters(tilt_step_rad=float(np.deg2rad(0.5)))


def bend() -> TerrainWorld:
    """A paved L through grass; the straight line between its ends crosses the grass."""
    material = np.full((130, 130), Material.LAWN, np.uint8)
    material[10:45, 10:120] = Material.ASPHALT
    material[10:120, 85:120] = Material.ASPHALT
    return TerrainWorld(material, 0.1, seed=41)


def drive(parameters: NavigationParameters) -> tuple[NavigationRecord, np.ndarray]:
    world = bend()
    record = navigate(
        world,
        (2.5, 2.7, 0.0),
        (10.2, 10.5),
        small_model(TILTING),
        TILTING,
        np.random.default_rng(1),
        parameters,
    )
    touched = world.touched(np.array(record.positions_m), parameters.radius_m)
    return record, touched


def test_the_goal_is_reached_around_the_grass() -> None:
    record, touched = drive(QUICK)
    assert record.reached, record.reason
    assert record.length_m() > 12.0
    assert not np.isin(touched, [Material.LAWN]).any()


def test_without_the_classifier_the_robot_drives_across() -> None:
    record, touched = drive(
        NavigationParameters(tilt_step_rad=QUICK.tilt_step_rad, avoid_vegetation=False)
    )
    assert record.reached, record.reason
    assert (touched == Material.LAWN).sum() > 50


def test_a_goal_amid_grass_is_given_up() -> None:
    record = navigate(
        bend(),
        (2.5, 2.7, 0.0),
        (4.0, 9.0),
        small_model(TILTING),
        TILTING,
        np.random.default_rng(2),
        QUICK,
    )
    assert not record.reached
    assert record.reason


@pytest.mark.parametrize("most", [1])
def test_an_endless_search_ends(most: int) -> None:
    record = navigate(
        bend(),
        (2.5, 2.7, 0.0),
        (10.2, 10.5),
        small_model(TILTING),
        TILTING,
        np.random.default_rng(3),
        NavigationParameters(most_scans=most, tilt_step_rad=QUICK.tilt_step_rad),
    )
    assert record.reason == "not there after 1 scans"
