import numpy as np

from simulator.vegetation.features import Measurements
from simulator.vegetation.remission_correction import corrected_remission


def test_inverts_the_range_equation() -> None:
    """A scanner that obeyed eq. 6.19 would give back the reflectivity."""
    random = np.random.default_rng(1)
    range_m, angle = random.uniform(0.5, 5, 50), random.uniform(0, 1.4, 50)
    reported = 0.4 * 0.9 * np.cos(angle) * 30 / range_m**2
    measured = Measurements(range_m, angle, reported)
    assert np.allclose(corrected_remission(measured, atmosphere=0.9, sensor_factor=30), 0.4)


def test_a_grazing_beam_stays_finite() -> None:
    grazing = Measurements(np.ones(1), np.full(1, np.pi / 2), np.ones(1))
    assert np.isfinite(corrected_remission(grazing)).all()
