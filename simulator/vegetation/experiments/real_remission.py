"""RELLIS-3D and SemanticKITTI: what carries over to spinning 3D scanners.

Splits are by sector of the scan, never random: a point's neighbours would give it away. The guarded
splits also leave out training points within 3.2 m of any test point, so that no neighbourhood is
shared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from simulator.vegetation.experiments import Setting
from simulator.vegetation.experiments.report import percent, table
from simulator.vegetation.features import Measurements
from simulator.vegetation.lda import train_lda
from simulator.vegetation.local_statistics import RADII_M, local_statistics
from simulator.vegetation.real_data.labelled_scan import (
    KITTI_PARKING,
    KITTI_ROAD,
    KITTI_SIDEWALK,
    KITTI_TERRAIN,
    RELLIS_CONCRETE,
    RELLIS_GRASS,
    LabelledScan,
    read_rellis,
    read_semantic_kitti,
)
from simulator.vegetation.remission_correction import corrected_remission
from simulator.vegetation.scores import Scores
from simulator.vegetation.svm import SvmParameters, train_svm

Array = NDArray[np.float64]
Folds = NDArray[np.int_]
MAX_RANGE_M = 30.0
SECTOR_RAD = np.deg2rad(30.0)
GUARD_M = 2 * RADII_M[-1]
TRAINING_SAMPLES = 2000
"""Of both classes together, half each."""


@dataclass(frozen=True)
class Ground:
    """Points of two kinds of ground with all features."""

    vegetation: NDArray[np.bool_]
    sector: Folds
    points_m: Array
    features: dict[str, Array]


def run(setting: Setting) -> str:
    """Returns the table; sets that are absent are named instead."""
    report = ["### Real remission: grass against hard ground below 30 m\n"]
    for name, scan, grass, hard in _scans(setting):
        if scan is None:
            report.append(f"{name} is not in {setting.data}: left out.\n")
            continue
        ground = ground_points(scan, grass, hard, every=8 if setting.quick else 1)
        report.append(
            f"**{name}**: {int(ground.vegetation.sum()):,} grass and "
            f"{int((~ground.vegetation).sum()):,} hard points of one scan. Balanced accuracy "
            "counts both classes alike.\n"
        )
        report.append(table(*accuracies(ground, quick=setting.quick)))
    return "\n".join(report)


def _scans(setting: Setting) -> list[tuple[str, LabelledScan | None, list[int], list[int]]]:
    rellis = setting.data / "rellis" / "000104.bin"
    kitti = setting.data / "semantickitti" / "000000.bin"
    return [
        (
            "RELLIS-3D (Ouster OS1-64, grass against concrete)",
            read_rellis(rellis, rellis.with_suffix(".label")) if rellis.is_file() else None,
            [RELLIS_GRASS],
            [RELLIS_CONCRETE],
        ),
        (
            "SemanticKITTI (HDL-64, terrain against road, parking, sidewalk)",
            read_semantic_kitti(kitti, kitti.with_suffix(".label")) if kitti.is_file() else None,
            [KITTI_TERRAIN],
            [KITTI_ROAD, KITTI_PARKING, KITTI_SIDEWALK],
        ),
    ]


def ground_points(scan: LabelledScan, grass: list[int], hard: list[int], every: int = 1) -> Ground:
    """The points of these labels with their feature sets.

    Neighbourhoods hold all returns, whatever their label: a robot would not know it.
    """
    range_m = np.linalg.norm(scan.points_m, axis=1)
    wanted = np.isin(scan.label, grass + hard) & (range_m < MAX_RANGE_M)
    chosen = np.flatnonzero(wanted)[::every]
    around = [local_statistics(scan.points_m, scan.remission, chosen, r) for r in RADII_M]
    angle = around[1][:, 0]
    near, remission = range_m[chosen], scan.remission[chosen]
    rough = np.column_stack([statistics[:, 1:4] for statistics in around])
    spread = np.column_stack([statistics[:, 4:7] for statistics in around])
    thesis = np.column_stack([near, angle, remission])
    features = {
        "range, angle (geometry only)": thesis[:, :2],
        "range, angle, remission (thesis)": thesis,
        "range, angle, remission corrected by eq. 6.19": np.column_stack(
            [thesis[:, :2], corrected_remission(Measurements(near, angle, remission))]
        ),
        "thesis + remission in 0.4 m": np.column_stack([thesis, around[1][:, 4:7]]),
        "thesis + remission at four scales": np.column_stack([thesis, spread]),
        "range, angle, roughness at four scales": np.column_stack([thesis[:, :2], rough]),
        "all of these": np.column_stack([thesis, rough, spread]),
    }
    sector = ((scan.azimuth_rad()[chosen] + np.pi) // SECTOR_RAD).astype(np.int_)
    return Ground(np.isin(scan.label[chosen], grass), sector, scan.points_m[chosen], features)


def accuracies(ground: Ground, *, quick: bool) -> tuple[list[str], list[list[str]]]:
    """Heads and rows: accuracy and balanced accuracy of each feature set in each split."""
    splits = {
        "sector of 30 degrees left out": (ground.sector, 0.0),
        "the same, guarded": (ground.sector, GUARD_M),
        "quadrant left out, guarded": (ground.sector // 3, GUARD_M),
    }
    if quick:
        splits = {"quadrant left out, guarded": splits["quadrant left out, guarded"]}
    rows = [[name] for name in ground.features]
    linear = ["LDA on roughness"]
    for folds, guard_m in splits.values():
        found = held_out(ground, folds, guard_m)
        for row, name in zip(rows, ground.features, strict=True):
            row.append(_both(found[name], ground.vegetation))
        linear.append(_both(found["LDA"], ground.vegetation))
    return ["features (SVM)", *splits], [*rows, linear]


def held_out(
    ground: Ground, folds: Folds, guard_m: float, names: Sequence[str] | None = None
) -> dict[str, NDArray[np.bool_]]:
    """Classes `(n,)` that each feature set gives to points whose fold was not trained on.

    `names` restricts the feature sets; LDA on roughness is always there.
    """
    chosen = {name: ground.features[name] for name in names or ground.features}
    found = {name: np.zeros(len(folds), np.bool_) for name in [*chosen, "LDA"]}
    random = np.random.default_rng(0)
    rough = "range, angle, roughness at four scales"
    for fold in np.unique(folds):
        test = folds == fold
        training = np.flatnonzero(~test)
        if guard_m > 0:
            near, _ = cKDTree(ground.points_m[test]).query(
                ground.points_m[training], distance_upper_bound=guard_m
            )
            training = training[~np.isfinite(near)]
        some = _balanced(training, ground.vegetation, random)
        for name, features in chosen.items():
            # No search: it would look at the test sectors of other folds.
            width = round(np.log2(0.5 / features.shape[1]))
            classifier = train_svm(
                features[some], ground.vegetation[some], None, SvmParameters((width,), (1,))
            )
            found[name][test] = classifier.vegetation_probability(features[test]) >= 0.5
        linear = train_lda(ground.features[rough][some], ground.vegetation[some])
        found["LDA"][test] = linear.vegetation_probability(ground.features[rough][test]) >= 0.5
    return found


def _balanced(
    training: NDArray[np.intp], vegetation: NDArray[np.bool_], random: np.random.Generator
) -> NDArray[np.intp]:
    parts = []
    for label in (False, True):
        of_class = training[vegetation[training] == label]
        count = min(TRAINING_SAMPLES // 2, len(of_class))
        parts.append(random.choice(of_class, count, replace=False))
    return np.concatenate(parts)


def _both(found: NDArray[np.bool_], truth: NDArray[np.bool_]) -> str:
    scores = Scores.of(found, truth)
    specificity = Scores.of(~found, ~truth).recall
    return f"{percent(scores.accuracy, 1)} ({percent((scores.recall + specificity) / 2, 1)})"
