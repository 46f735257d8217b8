"""Landmark maps of simulated drivers in a park, aligned pair by pair (4.6.2, Fig. 4.16 and 4.17).

Twenty drivers go round trips among 140 trunks on 300 x 300 m. A trunk detector reads the laser,
Kalman filters keep the landmarks, and at intervals every two drivers' maps are aligned. The truth
is known, so each accepted alignment is right or wrong.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.consensus import ConsensusMethod
from simulator.slam.detector import detect_poles
from simulator.slam.experiments.drive import Laser, OdometryNoise, Surveyor
from simulator.slam.experiments.statistics import table
from simulator.slam.landmark_alignment import AlignmentParameters, align_landmarks
from simulator.slam.landmarks import LandmarkMapper
from simulator.slam.pose import Points, Poses, between, compose, transform
from simulator.slam.triangles import Triangles, triangulate

EXTENT_M, TRUNKS, TRUNK_RADIUS_M = 300.0, 140, 0.25
SAME_PLACE_M = 1.0
"""landmarks of two maps that truly lie so near are shared"""
_LASER = Laser(beams=361, range_m=45.0, noise_m=0.02)
_GROUPS = (0, 5, 10, 20, 30, 40, 50, 60, 80, 100, 120, 141)


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """A driver's landmark map at some time."""

    landmarks_m: Points
    """(n, 2) in the driver's own frame"""
    truth_m: Points
    """(n, 2): the same in the park's frame, as the driver's true frame has them"""
    triangles: Triangles
    frame: Poses
    """(3,): the driver's frame in the park"""


@dataclass(frozen=True, slots=True)
class Trial:
    """One alignment of two drivers' maps."""

    shared: int
    found: bool
    accepted: bool
    error_m: float
    error_rad: float


def park(random: np.random.Generator) -> Points:
    """(140, 2): trunks at least three metres apart."""
    trunks: list[tuple[float, float]] = []
    while len(trunks) < TRUNKS:
        x, y = random.uniform(0.03 * EXTENT_M, 0.97 * EXTENT_M, 2).tolist()
        if all(math.dist((x, y), other) > 3.0 for other in trunks):
            trunks.append((x, y))
    return np.array(trunks)


def read_park(path: Path) -> Points:
    """Trunk positions of a file with a line x y each, moved into the positive quadrant."""
    trunks = np.loadtxt(path)[:, :2]
    return np.asarray(trunks - trunks.min(axis=0) + 10.0)


def round_trip(trunks: Points, random: np.random.Generator) -> Poses:
    """(n, 3): a closed smooth drive between the trunks, a pose a second at about 2.5 m/s."""
    centre = trunks.mean(axis=0) + random.normal(0.0, 15.0, 2)
    half = 0.5 * np.ptp(trunks, axis=0)
    laps = int(random.integers(1, 3))
    angle = np.linspace(0.0, laps * math.tau, 4000) + random.uniform(0.0, math.tau)
    reach = 0.6 + 0.25 * np.sin(angle / laps + random.uniform(0, 6))
    reach = reach + 0.1 * np.sin(5 * angle + random.uniform(0, 6))
    way = random.choice([-1.0, 1.0])
    x = centre[0] + half[0] * reach * np.cos(way * angle)
    y = centre[1] + half[1] * reach * np.sin(way * angle)
    line = np.stack([x, y], axis=1)
    driven = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = np.arange(0.0, driven[-1], 2.5)
    points = np.stack([np.interp(at, driven, x), np.interp(at, driven, y)], axis=1)
    ahead = np.diff(points, axis=0)
    return np.column_stack([points[:-1], np.arctan2(ahead[:, 1], ahead[:, 0])])


def snapshots(
    trunks: Points,
    random: np.random.Generator,
    every_s: int,
    odometry: OdometryNoise | None = None,
) -> list[Snapshot]:
    """One driver's maps at intervals; without odometry noise, as in the thesis."""
    low, high = trunks.min(axis=0) - 60.0, trunks.max(axis=0) + 60.0
    shape = (np.ceil((high - low) / 2.0)).astype(int)
    empty = np.zeros((int(shape[1]), int(shape[0])), dtype=np.int8)
    grid = OccupancyGrid(empty, 2.0, (float(low[0]), float(low[1])))
    surveyor = Surveyor(grid, [(float(x), float(y), TRUNK_RADIUS_M) for x, y in trunks])
    path = round_trip(trunks, random)
    quiet = OdometryNoise(0.0, 0.0, 0.0)
    drive = surveyor.drive(path, _LASER, odometry or quiet, random, period_s=1.0)
    mapper, taken = LandmarkMapper(), []
    for second, scan in enumerate(drive.scans):
        mapper.add(scan.odometry, detect_poles(scan))
        if second % every_s == every_s - 1 or second == len(drive.scans) - 1:
            found = mapper.landmark_map().positions_m
            if len(found) >= 3:
                in_park = transform(path[0], found)
                taken.append(Snapshot(found, in_park, triangulate(found), path[0]))
    return taken


def trials(
    drivers: Sequence[Sequence[Snapshot]],
    random: np.random.Generator,
    method: ConsensusMethod,
    repeats: int = 1,
    step: int = 1,
) -> Iterator[Trial]:
    """Every two drivers, at every common time, several times."""
    parameters = AlignmentParameters(method=method)
    for one, other in combinations(range(len(drivers)), 2):
        first, second = drivers[one], drivers[other]
        for moment in range(0, max(len(first), len(second)), step):
            a, b = first[min(moment, len(first) - 1)], second[min(moment, len(second) - 1)]
            for _ in range(repeats):
                yield _trial(a, b, random, parameters)


def _trial(
    a: Snapshot, b: Snapshot, random: np.random.Generator, parameters: AlignmentParameters
) -> Trial:
    apart = np.linalg.norm(a.truth_m[:, None] - b.truth_m[None], axis=2)
    shared = int(np.count_nonzero(apart.min(axis=1) < SAME_PLACE_M))
    found = align_landmarks(
        a.landmarks_m, b.landmarks_m, random, parameters, (a.triangles, b.triangles)
    )
    if found is None:
        return Trial(shared, False, False, float("nan"), float("nan"))
    truth = between(a.frame, b.frame)
    # The error where the second map is, not at its frame's far origin.
    middle = np.array([*b.landmarks_m.mean(axis=0), 0.0])
    away = between(compose(truth, middle), compose(found.motion, middle))
    return Trial(
        shared,
        True,
        found.accepted,
        float(np.hypot(away[0], away[1])),
        float(abs(away[2])),
    )


def report(by_method: dict[str, list[Trial]]) -> str:
    """Errors of accepted alignments by overlap; precision and recall of acceptance."""
    parts = []
    for method, done in by_method.items():
        rows = []
        for low, high in pairwise(_GROUPS):
            group = [trial for trial in done if low <= trial.shared < high]
            if not group:
                continue
            accepted = [trial for trial in group if trial.accepted]
            wrong = sum(_is_wrong(trial) for trial in accepted)
            errors = np.array([(t.error_m, t.error_rad) for t in accepted]).reshape(-1, 2)
            mean = errors.mean(axis=0) if len(errors) else np.full(2, np.nan)
            worst = errors.max(axis=0) if len(errors) else np.full(2, np.nan)
            rows.append(
                [
                    f"{low}-{high - 1}",
                    len(group),
                    f"{100 * len(accepted) / len(group):.1f} %",
                    wrong,
                    f"{mean[0]:.3f}",
                    f"{worst[0]:.2f}",
                    f"{mean[1]:.5f}",
                ]
            )
        heads = ["shared", "trials", "accepted", "wrong", "mean error [m]", "worst", "mean [rad]"]
        precision, recall = precision_and_recall(done)
        parts.append(
            f"{method}: {len(done)} trials, precision {precision:.4f}, recall {recall:.4f} among "
            f"trials with five or more shared landmarks\n\n{table(heads, rows)}"
        )
    return "\n\n".join(parts)


def _is_wrong(trial: Trial) -> bool:
    return not (trial.error_m < 2.0 and trial.error_rad < 0.1)


def precision_and_recall(done: Sequence[Trial]) -> tuple[float, float]:
    """Of the accepted ones, the share that is right; of those possible, the share accepted."""
    accepted = [trial for trial in done if trial.accepted]
    right = sum(not _is_wrong(trial) for trial in accepted)
    possible = sum(trial.shared >= 5 for trial in done)
    return right / max(1, len(accepted)), right / max(1, possible)


def success_below_thirty(done: Sequence[Trial]) -> NDArray[np.float64]:
    """(30,): share of trials with so many shared landmarks that ended with a right alignment."""
    shares = np.full(30, np.nan)
    for count in range(30):
        group = [trial for trial in done if trial.shared == count]
        if group:
            shares[count] = np.mean([t.accepted and not _is_wrong(t) for t in group])
    return shares
