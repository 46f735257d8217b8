"""Table 6.1 and section 6.9.1: self-supervised training in one place, test in another.

Three places share nothing but the materials' names: the vibration classifier is trained on short
tracks elsewhere, the laser classifier where the robot drives first, and the test is a third place.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.baselines import MeanRemissionClassifier, range_difference_features
from simulator.vegetation.experiments import Setting
from simulator.vegetation.experiments.report import BLUE, GREEN, figure, percent, save, table
from simulator.vegetation.experiments.training import SOME
from simulator.vegetation.features import Measurements
from simulator.vegetation.remission_correction import corrected_remission
from simulator.vegetation.scores import Scores
from simulator.vegetation.self_supervision import (
    LabelledMeasurements,
    SelfSupervisionParameters,
    label_scans,
    learn_from_drive,
)
from simulator.vegetation.simulation.recording import (
    PIONEER,
    self_supervised_drive,
    vibration_classifier,
)
from simulator.vegetation.simulation.remission_model import VEGETATION
from simulator.vegetation.simulation.scanning import Sweep
from simulator.vegetation.simulation.worlds import street_and_lawn
from simulator.vegetation.svm import SvmParameters, train_svm

TRAINING_SEED, TEST_SEED, TRACKS_SEED = 11, 2011, 5000
Array = NDArray[np.float64]


def run(setting: Setting) -> str:
    """Writes `remission.png` and returns the tables."""
    size_m, rows = ((24.0, 16.0), 2) if setting.quick else ((50.0, 24.0), 4)
    search = (
        SvmParameters((-3, -1), (1, 5), search_points=600) if setting.quick else SvmParameters()
    )
    terrain = vibration_classifier(TRACKS_SEED, 25.0 if setting.quick else 50.0)
    drive, sweeps = self_supervised_drive(
        street_and_lawn(TRAINING_SEED, size_m), TRAINING_SEED, rows
    )
    model, trained = learn_from_drive(
        drive, terrain, PIONEER, SelfSupervisionParameters(svm=search)
    )
    test_size_m = size_m if setting.quick else (80.0, 24.0)
    test_drive, test_sweeps = self_supervised_drive(
        street_and_lawn(TEST_SEED, test_size_m), TEST_SEED, rows
    )
    test = label_scans(test_drive, terrain)
    truth = _truth(test, test_sweeps)
    found = model.vegetation_probability(test.measurements, PIONEER) >= 0.5
    _draw(setting, trained)
    rows_of_baselines = _baselines(trained, sweeps, test, test_sweeps, truth)
    by_label, by_truth = Scores.of(found, test.vegetation), Scores.of(found, truth)
    labels = Scores.of(test.vegetation, truth)
    return "\n".join(
        [
            "### Table 6.1: vegetation from remission, trained by vibration\n",
            f"Training: {int(trained.vegetation.sum()):,} vegetation and "
            f"{int((~trained.vegetation).sum()):,} street measurements that the vibration "
            f"classifier labelled; test in another place with another seed. "
            f"Against the simulated truth, {percent(labels.accuracy, 3)} of the test labels are "
            "right.\n",
            table(
                ["measured against", "TP", "FP", "FN", "TN", "precision", "recall"],
                [
                    _row("labels by vibration, as in the thesis", by_label),
                    _row("simulated truth", by_truth),
                    ["thesis", "36,300", "4", "138", "28,745", "99.9 %", "99.6 %"],
                ],
            ),
            "### Section 6.9.1: what simpler features give on the same data\n",
            table(
                ["method", "accuracy", "precision", "recall"],
                [_short("SVM: range, angle, remission", by_truth), *rows_of_baselines],
            ),
            "![remission over range](remission.png)\n",
        ]
    )


def _row(name: str, scores: Scores) -> list[str]:
    counts = (
        scores.true_positives,
        scores.false_positives,
        scores.false_negatives,
        scores.true_negatives,
    )
    shares = percent(scores.precision), percent(scores.recall)
    return [name, *(f"{count:,}" for count in counts), *shares]


def _short(name: str, scores: Scores) -> list[str]:
    return [name, percent(scores.accuracy), percent(scores.precision), percent(scores.recall)]


def _truth(labelled: LabelledMeasurements, sweeps: list[Sweep]) -> NDArray[np.bool_]:
    grass = [int(kind) for kind in VEGETATION]
    return np.concatenate(
        [
            np.isin(sweep.material[labelled.index[labelled.scan == number]], grass)
            for number, sweep in enumerate(sweeps)
        ]
    )


def _baselines(
    trained: LabelledMeasurements,
    sweeps: list[Sweep],
    test: LabelledMeasurements,
    test_sweeps: list[Sweep],
    truth: NDArray[np.bool_],
) -> list[list[str]]:
    rows = []
    for name, values in (
        ("mean remission, no range or angle", lambda m: m.remission),
        ("mean of remission corrected by eq. 6.19", corrected_remission),
    ):
        naive = MeanRemissionClassifier.train(values(trained.measurements), trained.vegetation)
        rows.append(_short(name, Scores.of(naive.is_vegetation(values(test.measurements)), truth)))
    rough, rough_test = _roughness(trained, sweeps), _roughness(test, test_sweeps)
    usable, usable_test = np.isfinite(rough).all(axis=1), np.isfinite(rough_test).all(axis=1)
    some = np.flatnonzero(usable)[:: max(1, int(usable.sum()) // 4000)]
    # Overlapping classes: large C only makes LibSVM slow, so the grid is the smaller one here.
    classifier = train_svm(rough[some], trained.vegetation[some], trained.scan[some], SOME)
    found = classifier.vegetation_probability(rough_test[usable_test]) >= 0.5
    rows.append(_short("range differences (eqs. 6.27, 6.28)", Scores.of(found, truth[usable_test])))
    return rows


def _roughness(labelled: LabelledMeasurements, sweeps: list[Sweep]) -> Array:
    """`(n, 2)`: range-difference features of labelled measurements."""
    parts = []
    for number, sweep in enumerate(sweeps):
        shape = (int(sweep.line.max()) + 1, int(sweep.beam.max()) + 1)
        forward, range_m = np.full(shape, np.nan), np.full(shape, np.nan)
        forward[sweep.line, sweep.beam] = sweep.forward_m
        range_m[sweep.line, sweep.beam] = sweep.range_m()
        features = range_difference_features(forward, range_m)[sweep.line, sweep.beam]
        parts.append(features[labelled.index[labelled.scan == number]])
    return np.concatenate(parts)


def _draw(setting: Setting, labelled: LabelledMeasurements) -> None:
    """Figures 6.3 and 6.11: remission over range, as measured and corrected."""
    made, (left, right) = figure(10, 4, 2)
    measured: Measurements = labelled.measurements
    for axes, values, name in (
        (left, measured.remission, "remission"),
        (right, corrected_remission(measured), "corrected by eq. 6.19"),
    ):
        for label, colour, kind in ((False, BLUE, "street"), (True, GREEN, "vegetation")):
            some = np.flatnonzero(labelled.vegetation == label)[::8]
            axes.plot(measured.range_m[some], values[some], ".", ms=2, color=colour, label=kind)
        axes.set_xlabel("range [m]")
        axes.set_ylabel(name)
    left.legend(markerscale=5)
    save(made, setting.out / "remission.png")
