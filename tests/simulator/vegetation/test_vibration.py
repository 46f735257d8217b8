import numpy as np
import pytest

from simulator.vegetation.vibration import (
    VibrationParameters,
    VibrationRun,
    band_features,
    certain,
    thesis_windows,
)


def run(acceleration: np.ndarray, forward_m_s: float = 0.5) -> VibrationRun:
    count = len(acceleration)
    return VibrationRun(100.0, acceleration, np.full(count, forward_m_s), np.full(count, 0.1))


def test_a_sine_shows_in_its_line_of_the_spectrum() -> None:
    """128 samples at 100 Hz: line m is at m * 0.78125 Hz, the 32nd ends below 25 Hz."""
    time_s = np.arange(300) / 100.0
    windows = thesis_windows(run(3.0 * np.sin(2 * np.pi * 8 * 100 / 128 * time_s)))
    assert windows.features.shape == (3, 34)
    magnitudes = windows.features[0, :32]
    assert magnitudes.argmax() == 8
    assert magnitudes[8] == pytest.approx(3.0 * 128 / 2)
    assert windows.features[0, 32:].tolist() == pytest.approx([0.5, 0.1])


def test_only_the_first_axis_counts() -> None:
    both = np.random.default_rng(1).normal(size=(200, 6))
    assert np.array_equal(
        thesis_windows(run(both)).features, thesis_windows(run(both[:, 0])).features
    )


def test_a_standing_robot_feels_nothing() -> None:
    assert len(thesis_windows(run(np.ones(500), forward_m_s=0.0)).first) == 0


def test_border_windows_are_left_out() -> None:
    parameters = VibrationParameters()
    first = np.arange(10) * parameters.hop
    probability = np.array([0.0, 0.1, 0.1, 0.1, 0.9, 1.0, 1.0, 1.0, 0.6, 1.0])
    keep = certain(probability, first, parameters)
    assert keep.tolist() == [True, True, False, False, False, False, True, True, False, True]


def test_a_pause_between_windows_is_no_border() -> None:
    parameters = VibrationParameters()
    first = np.array([0, 10_000])
    assert certain(np.array([0.0, 1.0]), first, parameters).all()


def test_bands_follow_power_not_offset() -> None:
    """A constant does not change them; ten times the amplitude adds ln(100) to all."""
    random = np.random.default_rng(2)
    window = random.normal(size=(512, 6))
    bands = band_features(window, 200.0)
    assert bands.shape == (48,)
    assert np.allclose(band_features(window + 9.81, 200.0), bands)
    assert np.allclose(band_features(10 * window, 200.0) - bands, np.log(100.0), atol=1e-4)
