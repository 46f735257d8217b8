"""SVM against LDA for three scanners, and whether 6,480 beams a second are kept up with.

Times are CPU seconds of one thread. LibSVM, which the thesis used, evaluates the same support
vectors through scikit-learn; the sustained rate is counted for scans of 180 beams, one call each,
with the incidence angles' normals computed on the way.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.features import measure
from simulator.vegetation.lda import train_lda
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.recording import standing_recording
from simulator.vegetation.simulation.remission_model import SCANNERS
from simulator.vegetation.simulation.scanning import tilting_scan
from simulator.vegetation.simulation.worlds import street_and_lawn
from simulator.vegetation.svm import SvmClassifier, SvmParameters, train_svm

Array = NDArray[np.float64]
BEAMS, SCANS_HZ = 180, 36
PARAMETERS = SvmParameters((-7, -5, -3, -1, 1), (-1, 1, 3, 5, 7), search_points=1000)


def run(*, quick: bool, out: Path) -> str:
    """Returns a table with one row for each scanner."""
    del out
    heads = [
        "scanner",
        "support vectors",
        "SVM (LibSVM) 1/s",
        "SVM (arrays) 1/s",
        "LDA 1/s",
        "LibSVM / LDA",
        "arrays / LDA",
        "sustained with the SVM, normals included",
        "needed",
    ]
    rows = [heads, ["---"] * len(heads)]
    tilt = (float(np.deg2rad(20)),) * 2
    for name in list(SCANNERS)[: 1 if quick else None]:
        rows.append(_measure(SensorSetup(name, 0.6, tilt), quick=quick))
    return "\n".join(f"| {' | '.join(row)} |" for row in rows) + "\n"


def _measure(setup: SensorSetup, *, quick: bool) -> list[str]:
    measured, vegetation, groups = standing_recording(setup, (71, 72, 73, 74))
    some = np.random.default_rng(1).choice(
        len(measured), min(2000 if quick else 20_000, len(measured)), replace=False
    )
    features = measured.features()
    parameters = SvmParameters((-1,), (3,)) if quick else PARAMETERS
    svm = train_svm(features[some], vegetation[some], groups[some], parameters)
    lda = train_lda(features[some], vegetation[some])
    machine = _libsvm(svm, features[some], vegetation[some])
    batch = features[: 5_000 if quick else 50_000]
    standard = (batch - svm.mean) / svm.scale
    seconds = [
        _cpu_s(lambda: machine.decision_function(standard)),
        _cpu_s(lambda: svm.vegetation_probability(batch)),
        _cpu_s(lambda: lda.vegetation_probability(batch)),
    ]
    rates = [len(batch) / spent for spent in seconds]
    return [
        setup.scanner,
        str(len(svm.weights)),
        *(f"{rate:,.0f}" for rate in rates),
        f"{seconds[0] / seconds[2]:.0f}",
        f"{seconds[1] / seconds[2]:.0f}",
        f"{_sustained(svm, setup):,.0f}",
        f"{BEAMS * SCANS_HZ:,}",
    ]


def _libsvm(svm: SvmClassifier, features: Array, vegetation: NDArray[np.bool_]) -> Any:
    """scikit-learn's machine with the same parameters on the same samples."""
    from sklearn.svm import SVC

    standard = (features - svm.mean) / svm.scale
    return SVC(C=svm.c, gamma=svm.gamma, cache_size=500).fit(standard, vegetation)


def _sustained(svm: SvmClassifier, setup: SensorSetup) -> float:
    """Measurements a CPU second from points to probabilities, 180 at a time."""
    world = street_and_lawn(5)
    low = SensorSetup(setup.scanner, setup.height_m, (0.2, 0.5))
    sweep = tilting_scan(world, low, (20.0, 10.0, 0.5), np.random.default_rng(5), 0.005)
    calls = len(sweep) // BEAMS

    def classify() -> None:
        for call in range(calls):
            part = slice(call * BEAMS, (call + 1) * BEAMS)
            measured = measure(sweep.points_m[part], sweep.remission[part], sweep.sensor_m[part])
            svm.vegetation_probability(measured.features())

    return calls * BEAMS / _cpu_s(classify, least_s=0.5)


def _cpu_s(work: Callable[[], object], least_s: float = 1.0) -> float:
    """CPU time of one call: the fastest of several, after one to warm up."""
    work()
    best, spent = float("inf"), 0.0
    while spent < least_s:
        begin_s = time.process_time()
        work()
        taken = time.process_time() - begin_s
        best, spent = min(best, taken), spent + taken
    return best
