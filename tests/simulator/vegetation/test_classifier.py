import math

import numpy as np
import pytest

from simulator.vegetation.classifier import RemissionModel, WrongSetupError
from simulator.vegetation.features import Measurements
from simulator.vegetation.lda import LdaClassifier
from simulator.vegetation.sensor_setup import SensorSetup

SETUP = SensorSetup("LMS 151", 0.6, (0.35, 0.35))
MODEL = RemissionModel(LdaClassifier(np.array([0.0, 0.0, 1.0]), (10.0, 20.0), (1.0, 1.0)), SETUP)


def test_far_measurements_stay_unclassified() -> None:
    measured = Measurements(np.array([1.0, 4.9, 5.1]), np.zeros(3), np.array([20.0, 10.0, 20.0]))
    found = MODEL.vegetation_probability(measured, SETUP)
    assert found[0] > 0.99
    assert found[1] < 0.01
    assert math.isnan(found[2])


def test_measurements_of_another_set_up_are_refused() -> None:
    measured = Measurements(np.ones(1), np.zeros(1), np.ones(1))
    other = SensorSetup("LMS 151", 1.2, (0.35, 0.35))
    with pytest.raises(WrongSetupError, match=r"1\.20 m high.*train a model"):
        MODEL.vegetation_probability(measured, other)
