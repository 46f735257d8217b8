"""Table 6.2: SVM against LDA with Gaussians for three scanners, 70 degrees down, 0.6 m high.

2,000 training samples as in the thesis, but from other places than the test's: neighbouring
measurements of one place on both sides of a random split would prove little.
"""

from __future__ import annotations

import numpy as np

from simulator.vegetation.experiments import Setting
from simulator.vegetation.experiments.report import BLUE, GREEN, figure, percent, save, table
from simulator.vegetation.lda import train_lda
from simulator.vegetation.scores import Scores
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.recording import standing_recording
from simulator.vegetation.simulation.remission_model import SCANNERS
from simulator.vegetation.svm import SvmParameters, train_svm

THESIS = {
    "LMS 151": ("99.7 %", "100 %", "99.1 %", "99.8 %"),
    "LMS 291-S05": ("99.9 %", "100 %", "99.4 %", "100 %"),
    "UTM-30LX": ("99.9 %", "99.9 %", "96.3 %", "99.8 %"),
}
TRAINING_SEEDS, TEST_SEEDS = (61, 62, 63, 64), (161, 162, 163, 164)
STEEP = (float(np.deg2rad(70)),) * 2


def run(setting: Setting) -> str:
    """Writes `scanners.png` and returns the table."""
    parameters = (
        SvmParameters((-3, 1), (1, 5), search_points=600) if setting.quick else SvmParameters()
    )
    lines = 15 if setting.quick else 80
    rows = []
    made, panels = figure(13, 4, len(SCANNERS))
    for axes, name in zip(panels, SCANNERS, strict=True):
        setup = SensorSetup(name, 0.6, STEEP)
        measured, vegetation, groups = standing_recording(setup, TRAINING_SEEDS, lines)
        test, truth, _ = standing_recording(setup, TEST_SEEDS, lines)
        some = np.random.default_rng(62).choice(len(measured), 2000, replace=False)
        features = measured.features()
        svm = train_svm(features[some], vegetation[some], groups[some], parameters)
        lda = train_lda(features[some], vegetation[some])
        scores = [
            Scores.of(classifier.vegetation_probability(test.features()) >= 0.5, truth)
            for classifier in (svm, lda)
        ]
        rows.append(
            [
                name,
                *(f(s) for s in scores for f in (_precision, _recall)),
                str(len(svm.weights)),
                " / ".join(THESIS[name]),
            ]
        )
        for label, colour, kind in ((False, BLUE, "street"), (True, GREEN, "vegetation")):
            shown = np.flatnonzero(vegetation == label)[::25]
            at, value = measured.range_m[shown], measured.remission[shown]
            axes.plot(at, value, ".", ms=2, color=colour, label=kind)
        axes.set_title(name)
        axes.set_xlabel("range [m]")
        axes.set_ylabel("remission")
    panels[0].legend(markerscale=5)
    save(made, setting.out / "scanners.png")
    heads = [
        "scanner",
        "precision SVM",
        "recall SVM",
        "precision LDA",
        "recall LDA",
        "support vectors",
        "thesis (same order)",
    ]
    return "\n".join(
        [
            "### Table 6.2: three scanners\n",
            f"Trained on 2,000 samples of four places, tested on {len(truth):,} of four others.\n",
            table(heads, rows),
            "![remission of three scanners](scanners.png)\n",
        ]
    )


def _precision(scores: Scores) -> str:
    return percent(scores.precision)


def _recall(scores: Scores) -> str:
    return percent(scores.recall)
