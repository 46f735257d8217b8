"""CPU time of landmark matching, its growth, and of Monte Carlo localization."""

from __future__ import annotations

import time

import numpy as np

from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.experiments.drive import Drive, Laser, OdometryNoise, Surveyor
from simulator.slam.experiments.floors import office_floor
from simulator.slam.experiments.statistics import table
from simulator.slam.landmark_alignment import AlignmentParameters, align_landmarks
from simulator.slam.localization import LocalizationParameters, SensorField, localize
from simulator.slam.pose import inverse, transform


def speed(*, quick: bool) -> str:
    """Markdown: matching at 140 landmarks and more, localization with 40 scans."""
    return f"{_matching(quick)}\n\n{_localization()}"


def _matching(quick: bool) -> str:
    random = np.random.default_rng(0)
    rows = []
    base = None
    for count in (140, 1000, 5000) if quick else (140, 1000, 5000, 10_000, 20_000):
        repeats = 20 if count == 140 else 1
        times, right = [], 0
        for _ in range(repeats):
            extent = 300.0 * np.sqrt(count / 140.0)
            first = random.uniform(0.0, extent, (count, 2))
            truth = np.array([*random.uniform(-100.0, 100.0, 2), random.uniform(-3.0, 3.0)])
            second = transform(inverse(truth), first + random.normal(0.0, 0.05, first.shape))
            begin = time.process_time()
            found = align_landmarks(first, random.permutation(second), random)
            times.append(time.process_time() - begin)
            right += bool(found and found.accepted and np.hypot(*(found.motion - truth)[:2]) < 1.0)
        spent = float(np.median(times))
        share = spent / (count * np.log2(count))
        base = base or share
        rows.append([count, f"{1000 * spent:.1f}", f"{right}/{repeats}", f"{share / base:.2f}"])
    pcm = _clique_ms(random)
    heads = ["landmarks", "CPU ms", "right", "time per n log n, 140 = 1"]
    return (
        f"{table(heads, rows)}\n\nTriangulation of both maps included; RANSAC. With the largest "
        f"consistent clique instead, 140 landmarks take {pcm:.1f} ms."
    )


def _clique_ms(random: np.random.Generator) -> float:
    times = []
    for _ in range(10):
        first = random.uniform(0.0, 300.0, (140, 2))
        second = first + random.normal(0.0, 0.05, first.shape)
        begin = time.process_time()
        align_landmarks(first, second, random, AlignmentParameters(method="pcm"))
        times.append(time.process_time() - begin)
    return 1000.0 * float(np.median(times))


def _localization() -> str:
    """Forty scans in a map of at least 50 x 50 m of which the floor takes a part."""
    grid, stops = office_floor(7, 0, rooms=8)
    surveyor = Surveyor(grid)
    random = np.random.default_rng(1)
    path = surveyor.path(stops)[::2]
    drive = surveyor.drive(path, Laser(range_m=25.0), OdometryNoise(), random)
    open_hall = _hall()
    rows = []
    for name, floor, drives in (("office", grid, drive), ("50 x 50 m hall", *open_hall)):
        sensor_field = SensorField(floor, LocalizationParameters())
        times, found = [], 0
        for start in range(0, min(len(drives.scans) - 40, 200), 20):
            posed = [(scan.odometry, scan) for scan in drives.scans[start : start + 40]]
            begin = time.process_time()
            found += localize(sensor_field, posed, random) is not None
            times.append(time.process_time() - begin)
        rows.append(
            [name, f"{sensor_field.free_area_m2:.0f}", len(times), found, f"{max(times):.2f}"]
        )
    heads = ["map", "free area [m2]", "sequences", "converged", "slowest, CPU s"]
    return f"Global localization by 40 scans:\n\n{table(heads, rows)}"


def _hall() -> tuple[OccupancyGrid, Drive]:
    """A hall with pillars and cupboards, and a drive through it."""
    random = np.random.default_rng(3)
    cells = np.full((1000, 1000), 100, dtype=np.int8)
    cells[6:-6, 6:-6] = 0
    for _ in range(25):
        row, column = random.integers(60, 900, 2)
        cells[row : row + random.integers(8, 40), column : column + random.integers(8, 40)] = 100
    cells[90:130, 90:910] = 0
    cells[90:910, 870:910] = 0
    grid = OccupancyGrid(cells, 0.05, (0.0, 0.0))
    surveyor = Surveyor(grid)
    path = surveyor.path([(5.5, 5.5), (44.5, 5.5), (44.5, 44.0)], step_m=0.4)
    return grid, surveyor.drive(path, Laser(range_m=30.0), OdometryNoise(), random)
