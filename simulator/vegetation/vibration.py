"""Terrain from vibration: spectra of windows of acceleration, and what to do at borders (6.4.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch

Array = NDArray[np.float64]


@dataclass(frozen=True)
class VibrationRun:
    """A run of an inertial measurement unit and the vehicle's odometry; `(n,)` samples."""

    rate_hz: float
    acceleration_m_s2: Array
    """`(n,)`: along the vertical axis; or `(n, axes)`, angular rates [rad/s] among them."""
    forward_m_s: Array
    rotation_rad_s: Array


@dataclass(frozen=True, slots=True)
class VibrationParameters:
    """The thesis's windows: 128 samples at 100 Hz, so that 32 magnitudes reach to 25 Hz."""

    window: int = 128
    hop: int = 64
    magnitudes: int = 32
    least_speed_m_s: float = 0.1
    """A robot that stands cannot feel what it stands on."""
    least_certainty: float = 0.8
    """Windows whose class is less probable than this are uncertain."""


@dataclass(frozen=True)
class VibrationWindows:
    """Features and places in time of the windows of a run."""

    features: Array
    """`(k, d)`"""
    first: NDArray[np.intp]
    """`(k,)`: sample that a window begins with."""
    samples: int
    """Length of a window."""


def thesis_windows(
    run: VibrationRun, parameters: VibrationParameters | None = None
) -> VibrationWindows:
    """Windows with |F_0| ... |F_31|, mean forward and mean rotational velocity (eqs. 6.16, 6.17).

    The first column of a run with several axes is the vertical acceleration. Windows in which the
    robot stands are left out.
    """
    parameters = parameters or VibrationParameters()
    vertical = run.acceleration_m_s2.reshape(len(run.acceleration_m_s2), -1)[:, 0]
    count = parameters.window
    first = np.arange(0, len(vertical) - count + 1, parameters.hop)
    inside = first[:, None] + np.arange(count)
    forward = run.forward_m_s[inside].mean(axis=1)
    moving = np.abs(forward) >= parameters.least_speed_m_s
    first, inside = first[moving], inside[moving]
    magnitudes = np.abs(np.fft.rfft(vertical[inside], axis=1))[:, : parameters.magnitudes]
    rotation = run.rotation_rad_s[inside].mean(axis=1)
    features = np.column_stack([magnitudes, forward[moving], rotation])
    return VibrationWindows(features, first, count)


def band_features(window: Array, rate_hz: float, bands: int = 8, segment: int = 128) -> Array:
    """Log power of `(n, axes)` samples in bands of equal width in log frequency, all axes in a row.

    Wider than the thesis's spectrum (all axes, up to half the rate), and pooled over the segments
    of a longer window (Welch's method). No frequency below the second line of the spectrum is used,
    because slopes and the way a sensor is mounted show there.
    """
    frequency, power = welch(window, rate_hz, nperseg=min(segment, len(window)), axis=0)
    edges = np.geomspace(1.5 * frequency[1], 1.001 * frequency[-1], bands + 1)
    band = np.digitize(frequency, edges) - 1
    sums = [power[band == k].sum(axis=0) for k in range(bands)]
    return np.asarray(np.log(np.stack(sums) + 1e-9).T.ravel())


def certain(
    vegetation_probability: Array, first: NDArray[np.intp], parameters: VibrationParameters
) -> NDArray[np.bool_]:
    """Windows `(k,)` to learn from: certain ones with no other class within a window's length.

    At a border part of the robot is on the one terrain and part on the other (section 6.4.1).
    """
    label = vegetation_probability >= 0.5
    sure = np.maximum(vegetation_probability, 1 - vegetation_probability)
    keep = sure >= parameters.least_certainty
    follows = np.diff(first) <= 2 * parameters.hop
    border = follows & (label[1:] != label[:-1])
    for shift in range(-(-parameters.window // parameters.hop)):
        # Window k - shift ends, and window k + 1 + shift begins, less than a window from border k.
        keep[: len(border) - shift] &= ~border[shift:]
        keep[1 + shift :] &= ~border[: len(border) - shift]
    return np.asarray(keep)
