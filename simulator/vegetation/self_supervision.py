"""A laser classifier that trains itself from what the vehicle feels later (section 6.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.classifier import Classifier, RemissionModel
from simulator.vegetation.features import MAX_RANGE_M, Measurements, measure
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.svm import SvmParameters, train_svm
from simulator.vegetation.vibration import (
    VibrationParameters,
    VibrationRun,
    certain,
    thesis_windows,
)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RecordedScan:
    """A 3D scan of a drive."""

    time_s: float
    points_m: Array
    """`(n, 3)` in the map frame."""
    remission: Array
    """`(n,)`"""
    sensor_m: Array
    """`(3,)` or `(n, 3)`: where the scanner was, in the map frame."""


@dataclass(frozen=True)
class RecordedDrive:
    """What a robot recorded while it drove over ground that it had scanned before."""

    time_s: Array
    """`(n,)`: of the samples of `vibration` and `poses`."""
    poses: Array
    """`(n, 3)`: x, y [m] and heading [rad] in the map frame."""
    vibration: VibrationRun
    scans: Sequence[RecordedScan]


@dataclass(frozen=True, slots=True)
class SelfSupervisionParameters:
    """How labels flow from the wheels to the laser."""

    cell_m: float = 0.1
    """Edge of the map's cells."""
    body_radius_m: float = 0.25
    """The ground within this distance from the robot's centre gets the label of a window."""
    vibration: VibrationParameters = field(default_factory=VibrationParameters)
    svm: SvmParameters = field(default_factory=SvmParameters)


@dataclass(frozen=True)
class LabelledMeasurements:
    """Laser measurements with the terrain that the vehicle felt there later."""

    measurements: Measurements
    vegetation: NDArray[np.bool_]
    scan: NDArray[np.int_]
    """Number of the scan that a measurement is from."""
    index: NDArray[np.intp]
    """Its number in the scan."""


def label_scans(
    drive: RecordedDrive,
    terrain: Classifier,
    parameters: SelfSupervisionParameters | None = None,
) -> LabelledMeasurements:
    """Labels the measurements of ground that the robot drove over after it had scanned it.

    `terrain` classifies vibration windows. Cells with contradicting labels are left out.
    """
    parameters = parameters or SelfSupervisionParameters()
    labels = _driven_cells(drive, terrain, parameters)
    parts: list[Measurements] = []
    vegetation, numbers, indices = [], [], []
    for number, scan in enumerate(drive.scans):
        measured = measure(scan.points_m, scan.remission, scan.sensor_m)
        cells = np.floor(scan.points_m[:, :2] / parameters.cell_m).astype(np.int64)
        label, since_s = _look_up(labels, cells)
        usable = (label >= 0) & (scan.time_s < since_s) & (measured.range_m < MAX_RANGE_M)
        parts.append(measured[usable])
        vegetation.append(label[usable] == 1)
        numbers.append(np.full(int(usable.sum()), number))
        indices.append(np.flatnonzero(usable))
    return LabelledMeasurements(
        Measurements.joined(parts),
        np.concatenate(vegetation),
        np.concatenate(numbers),
        np.concatenate(indices),
    )


def learn_from_drive(
    drive: RecordedDrive,
    terrain: Classifier,
    setup: SensorSetup,
    parameters: SelfSupervisionParameters | None = None,
) -> tuple[RemissionModel, LabelledMeasurements]:
    """The whole loop: vibration windows, labels through the map, training of the laser classifier.

    Raises:
        ValueError: the drive did not cover both kinds of ground.
    """
    parameters = parameters or SelfSupervisionParameters()
    labelled = label_scans(drive, terrain, parameters)
    if labelled.vegetation.all() or not labelled.vegetation.any():
        missing = "pavement" if len(labelled.vegetation) and labelled.vegetation.any() else "grass"
        raise ValueError(
            f"no scanned ground was driven over and felt like {missing}: "
            "scan both kinds of ground, then drive over them"
        )
    classifier = train_svm(
        labelled.measurements.features(), labelled.vegetation, labelled.scan, parameters.svm
    )
    return RemissionModel(classifier, setup), labelled


_Cells = dict[tuple[int, int], tuple[int, float]]


def _driven_cells(
    drive: RecordedDrive, terrain: Classifier, parameters: SelfSupervisionParameters
) -> _Cells:
    """Label (1 vegetation, 0 not, -1 contradicting) and time of the first pass of each cell."""
    windows = thesis_windows(drive.vibration, parameters.vibration)
    probability = terrain.vegetation_probability(windows.features)
    keep = certain(probability, windows.first, parameters.vibration)
    reach = int(np.ceil(parameters.body_radius_m / parameters.cell_m))
    offsets = np.mgrid[-reach : reach + 1, -reach : reach + 1].reshape(2, -1).T
    offsets = offsets[
        np.linalg.norm(offsets, axis=1) * parameters.cell_m <= parameters.body_radius_m
    ]
    cells: _Cells = {}
    for k in np.flatnonzero(keep):
        span = slice(windows.first[k], windows.first[k] + windows.samples, 8)
        centres = np.floor(drive.poses[span, :2] / parameters.cell_m).astype(np.int64)
        covered = np.unique((centres[:, None] + offsets).reshape(-1, 2), axis=0)
        label, time_s = int(probability[k] >= 0.5), float(drive.time_s[windows.first[k]])
        for column, row in covered.tolist():
            before = cells.setdefault((column, row), (label, time_s))
            if before[0] != label:
                cells[column, row] = (-1, before[1])
    return cells


def _look_up(labels: _Cells, cells: NDArray[np.int64]) -> tuple[NDArray[np.int_], Array]:
    unique, inverse = np.unique(cells, axis=0, return_inverse=True)
    found = [labels.get((column, row), (-1, -np.inf)) for column, row in unique.tolist()]
    label = np.array([entry[0] for entry in found], dtype=np.int_).reshape(-1)
    since_s = np.array([entry[1] for entry in found], dtype=np.float64).reshape(-1)
    return label[inverse.ravel()], since_s[inverse.ravel()]
