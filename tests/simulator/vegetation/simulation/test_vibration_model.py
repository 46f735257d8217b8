import numpy as np

from simulator.vegetation.simulation.remission_model import Material
from simulator.vegetation.simulation.terrain_world import TerrainWorld
from simulator.vegetation.simulation.vibration_model import RATE_HZ, drive_along


def drive(material: Material, speed_m_s: float) -> np.ndarray:
    world = TerrainWorld(np.full((100, 700), material, np.uint8), 0.1, seed=1)
    line = np.column_stack([np.arange(2.0, 62.0, 0.25), np.full(240, 5.0)])
    driven = drive_along(world, line, np.random.default_rng(1), (speed_m_s, speed_m_s))
    return driven.vibration.acceleration_m_s2


def test_grass_shakes_more_than_asphalt_and_lower() -> None:
    grass, asphalt = drive(Material.LAWN, 0.7), drive(Material.ASPHALT, 0.7)
    assert grass.std() > 2 * asphalt.std()

    def mean_frequency(series: np.ndarray) -> float:
        power = np.abs(np.fft.rfft(series)) ** 2
        return float(power @ np.fft.rfftfreq(len(series), 1 / RATE_HZ) / power.sum())

    assert mean_frequency(grass) < mean_frequency(asphalt)


def test_amplitude_grows_with_the_square_root_of_speed() -> None:
    slow, fast = drive(Material.LAWN, 0.25), drive(Material.LAWN, 1.0)
    assert 1.8 < fast.std() / slow.std() < 2.2


def test_the_odometry_fits_the_way() -> None:
    world = TerrainWorld(np.full((200, 200), Material.ASPHALT, np.uint8), 0.1, seed=1)
    corner = np.array([[2.0, 2.0], [12.0, 2.0], [12.0, 12.0]])
    driven = drive_along(world, corner, np.random.default_rng(2))
    forward_m = driven.vibration.forward_m_s.sum() / RATE_HZ
    assert abs(forward_m - 20.0) < 0.1
    turned = driven.vibration.rotation_rad_s.sum() / RATE_HZ
    assert abs(turned - np.pi / 2) < 0.1
    assert np.allclose(driven.poses[-1, :2], [12.0, 12.0], atol=0.02)
