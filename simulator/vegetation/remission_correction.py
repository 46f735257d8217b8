"""Remission corrected for range and incidence angle (section 6.7)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.features import Measurements


def corrected_remission(
    measurements: Measurements, atmosphere: float = 1.0, sensor_factor: float = 1.0
) -> NDArray[np.float64]:
    """Reflectivity `(n,)` up to a factor, by inverting eq. 6.19 (Höfle and Pfeifer, 2007).

    It assumes constant emitted power and a remission linear in the received power. Scanners that
    map power to remission in another way keep a dependency on range (figure 6.11), which is why
    the classifiers work on the uncorrected features.
    """
    cosine = np.maximum(np.cos(measurements.incidence_rad), 1e-3)
    factor = measurements.range_m**2 / (atmosphere * cosine * sensor_factor)
    return np.asarray(measurements.remission * factor)
