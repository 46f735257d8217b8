"""What a vegetation classifier offers, and one bound to the set-up that it was trained in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.features import MAX_RANGE_M, Measurements
from simulator.vegetation.sensor_setup import SensorSetup


class Classifier(Protocol):
    """Features `(n, d)` to P(vegetation) `(n,)`."""

    def vegetation_probability(self, features: NDArray[np.float64]) -> NDArray[np.float64]: ...


class WrongSetupError(ValueError):
    """A model was to be used with another scanner or mounting than it was trained with."""


@dataclass(frozen=True)
class RemissionModel:
    """A classifier of laser measurements with the set-up that it is good for."""

    classifier: Classifier
    setup: SensorSetup
    max_range_m: float = MAX_RANGE_M

    def vegetation_probability(
        self, measurements: Measurements, setup: SensorSetup
    ) -> NDArray[np.float64]:
        """P(vegetation) `(n,)` of measurements; NaN beyond `max_range_m`.

        Raises:
            WrongSetupError: `setup`, with which they were measured, is not the model's.
        """
        mismatch = setup.mismatch(self.setup)
        if mismatch is not None:
            raise WrongSetupError(f"{mismatch}: train a model for this set-up")
        found = np.full(len(measurements), np.nan)
        near = measurements.range_m < self.max_range_m
        found[near] = self.classifier.vegetation_probability(measurements[near].features())
        return found
