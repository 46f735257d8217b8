import math

import pytest

from simulator.vegetation.sensor_setup import SensorSetup

TRAINED = SensorSetup("LMS 291-S05", 0.55, (math.radians(-50), math.radians(30)))


def test_a_similar_configuration_is_accepted() -> None:
    similar = SensorSetup("LMS 291-S05", 0.58, (math.radians(-48), math.radians(31)))
    assert similar.mismatch(TRAINED) is None


@pytest.mark.parametrize(
    ("other", "why"),
    [
        (SensorSetup("LMS 151", 0.55, TRAINED.tilt_rad), "'LMS 291-S05'"),
        (SensorSetup("LMS 291-S05", 0.9, TRAINED.tilt_rad), "0.90 m high"),
        (SensorSetup("LMS 291-S05", 0.55, (0.35, 0.35)), "20 to 20 degrees"),
    ],
)
def test_another_one_is_refused_with_the_reason(other: SensorSetup, why: str) -> None:
    mismatch = other.mismatch(TRAINED)
    assert mismatch is not None
    assert why in mismatch
