"""Shared by the tests of this room: small models, trained once."""

from functools import cache

from simulator.vegetation.classifier import RemissionModel
from simulator.vegetation.lda import train_lda
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.recording import standing_recording
from simulator.vegetation.svm import SvmParameters, train_svm


@cache
def small_model(setup: SensorSetup, kind: str = "svm") -> RemissionModel:
    """Trained in front of street and lawn of places 1 and 2."""
    measured, vegetation, groups = standing_recording(setup, (1, 2), lines=20)
    features = measured.features()
    if kind == "lda":
        return RemissionModel(train_lda(features, vegetation), setup)
    chosen = slice(None, None, 8)
    return RemissionModel(
        train_svm(
            features[chosen],
            vegetation[chosen],
            groups[chosen],
            SvmParameters(log2_gamma=(-1,), log2_c=(3,)),
        ),
        setup,
    )
