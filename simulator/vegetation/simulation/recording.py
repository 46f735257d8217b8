"""Simulated recordings: the Pioneer's self-supervised drives, and drives to train by standing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.vegetation.features import MAX_RANGE_M, Measurements, measure
from simulator.vegetation.self_supervision import RecordedDrive, RecordedScan
from simulator.vegetation.sensor_setup import SensorSetup
from simulator.vegetation.simulation.remission_model import PAVED, VEGETATION
from simulator.vegetation.simulation.scanning import Sweep, scan_lines, tilting_scan
from simulator.vegetation.simulation.terrain_world import TerrainWorld
from simulator.vegetation.simulation.vibration_model import drive_along
from simulator.vegetation.simulation.worlds import street_and_lawn
from simulator.vegetation.svm import SvmClassifier, SvmParameters, train_svm
from simulator.vegetation.vibration import thesis_windows

Array = NDArray[np.float64]

PIONEER = SensorSetup("LMS 291-S05", 0.55, (float(np.deg2rad(-50)), float(np.deg2rad(30))))
"""Tilted from 50 degrees upwards to 30 degrees downwards (section 6.9)."""
POWERBOT = SensorSetup("LMS 291-S05", 0.60, (float(np.deg2rad(20)),) * 2)
"""Fixed, 20 degrees downwards (section 6.9.3)."""
EUROPA = SensorSetup("LMS 151", 0.60, (float(np.deg2rad(20)),) * 2)
"""Fixed; the thesis names no angle in section 6.9.5."""


def self_supervised_drive(
    world: TerrainWorld,
    seed: int,
    rows: int = 4,
    scan_spacing_m: float = 4.0,
    setup: SensorSetup = PIONEER,
) -> tuple[RecordedDrive, list[Sweep]]:
    """Drives up and down between street and lawn, stopping for a 3D scan every few metres.

    Returns the recording and, as truth, its sweeps.
    """
    random = np.random.default_rng([seed, 7])
    path = serpentine(world.size_m, rows)
    felt = drive_along(world, path, random)
    along = np.concatenate(
        [[0.0], np.cumsum(np.linalg.norm(np.diff(felt.poses[:, :2], axis=0), axis=1))]
    )
    stops = np.searchsorted(along, np.arange(0.0, along[-1], scan_spacing_m))
    sweeps, scans = [], []
    for stop in stops:
        x, y, heading = felt.poses[stop].tolist()
        sweep = tilting_scan(world, setup, (x, y, heading), random)
        sweeps.append(sweep)
        scans.append(
            RecordedScan(
                float(felt.time_s[stop]), sweep.points_m, sweep.remission, sweep.sensor_m[0]
            )
        )
    return RecordedDrive(felt.time_s, felt.poses, felt.vibration, scans), sweeps


def serpentine(size_m: tuple[float, float], rows: int) -> Array:
    """A way `(k, 2)`: rows on a place's lower and upper half, and one that weaves between."""
    width, height = size_m
    x = np.arange(4.0, width - 4.0, 0.25)
    weaving = height * (0.5 + 0.2 * np.sin(2 * np.pi * x / 16.0))
    straight = [np.full(len(x), y) for y in np.linspace(0.18 * height, 0.82 * height, rows)]
    points = []
    for row, y in enumerate([*straight, weaving]):
        line = np.column_stack([x, y])
        points.append(line if row % 2 == 0 else line[::-1])
    return np.concatenate(points)


def vibration_classifier(
    seed: int, length_m: float = 50.0, parameters: SvmParameters | None = None
) -> SvmClassifier:
    """Trained on short tracks at varying speeds on streets and on grass (section 6.4.1)."""
    features, vegetation, groups = [], [], []
    for track in range(4):
        world = street_and_lawn(seed + 100 * track, (length_m + 10.0, 20.0))
        random = np.random.default_rng([seed, track, 8])
        for y, grass in ((2.0, False), (18.0, True)):
            x = np.arange(5.0, length_m + 5.0, 0.25)
            line = np.column_stack([x, np.full(len(x), y)])
            windows = thesis_windows(drive_along(world, line, random).vibration)
            features.append(windows.features)
            vegetation.append(np.full(len(windows.first), grass))
            groups.append(np.full(len(windows.first), track))
    chosen = parameters or SvmParameters(log2_gamma=(-9, -7, -5, -3), log2_c=(-1, 1, 3, 5))
    return train_svm(
        np.concatenate(features), np.concatenate(vegetation), np.concatenate(groups), chosen
    )


def standing_recording(
    setup: SensorSetup, seeds: tuple[int, ...], lines: int = 80
) -> tuple[Measurements, NDArray[np.bool_], NDArray[np.int_]]:
    """Measurements in front of plain street and plain grass (section 6.9.3).

    A fixed scanner is moved forward, a tilting one makes one sweep of as many lines. Returns
    measurements, whether they are vegetation, and the number of the recording.
    """
    parts, vegetation, groups = [], [], []
    for number, seed in enumerate(seeds):
        world = street_and_lawn(seed)
        random = np.random.default_rng([seed, 9])
        width, height = world.size_m
        for y in (0.2 * height, 0.8 * height):
            low, high = setup.tilt_rad
            forward_m = 0.05 if low == high else 0.0
            x = random.uniform(2.0, width - 12.0) + forward_m * np.arange(lines)
            poses = np.column_stack([x, np.full(lines, y), np.zeros(lines)])
            tilts = np.linspace(low, high, lines)
            sweep = scan_lines(world, setup, poses, tilts, random)
            measured = measure(sweep.points_m, sweep.remission, sweep.sensor_m)
            usable = sweep.on_ground & (measured.range_m < MAX_RANGE_M)
            usable &= np.isin(sweep.material, [int(kind) for kind in VEGETATION | PAVED])
            parts.append(measured[usable])
            vegetation.append(np.isin(sweep.material[usable], [int(kind) for kind in VEGETATION]))
            groups.append(np.full(int(usable.sum()), number))
    return Measurements.joined(parts), np.concatenate(vegetation), np.concatenate(groups)
