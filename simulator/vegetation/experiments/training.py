"""Models that several experiments use, each trained in places of its own."""

from __future__ import annotations

import numpy as np

from simulator.vegetation.classifier import RemissionModel
from simulator.vegetation.self_supervision import SelfSupervisionParameters, learn_from_drive
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.recording import (
    PIONEER,
    self_supervised_drive,
    standing_recording,
    vibration_classifier,
)
from simulator.vegetation.simulation.worlds import street_and_lawn
from simulator.vegetation.svm import SvmParameters, train_svm

SOME = SvmParameters((-7, -5, -3, -1, 1), (-1, 1, 3, 5, 7), search_points=1000)
QUICK = SvmParameters((-1,), (3,))


def trained_standing(setup: SensorSetup, *, quick: bool, samples: int = 8000) -> RemissionModel:
    """In front of street and grass only, as for robots that must not drive on grass (6.9.3)."""
    measured, vegetation, groups = standing_recording(
        setup, (71, 72, 73, 74), lines=20 if quick else 80
    )
    count = min(samples // (4 if quick else 1), len(measured))
    some = np.random.default_rng(71).choice(len(measured), count, replace=False)
    classifier = train_svm(
        measured.features()[some], vegetation[some], groups[some], QUICK if quick else SOME
    )
    return RemissionModel(classifier, setup)


def trained_by_itself(*, quick: bool) -> RemissionModel:
    """The Pioneer's, from vibration."""
    terrain = vibration_classifier(5000, 25.0 if quick else 50.0)
    size_m, rows = ((24.0, 16.0), 2) if quick else ((50.0, 24.0), 4)
    drive, _ = self_supervised_drive(street_and_lawn(11, size_m), 11, rows)
    parameters = SelfSupervisionParameters(svm=QUICK if quick else SOME)
    return learn_from_drive(drive, terrain, PIONEER, parameters)[0]
