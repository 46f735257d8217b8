"""Three robots in a parking lot with poles and parked cars, each in a frame of its own (4.6.1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.back_end import BackEndParameters, optimise
from simulator.slam.detector import PoleParameters, detect_poles
from simulator.slam.experiments.drive import Disc, Laser, OdometryNoise, Surveyor
from simulator.slam.landmark_alignment import AlignmentParameters, align_landmarks
from simulator.slam.landmarks import LandmarkMapper, LandmarkParameters
from simulator.slam.merging import Alignment, MergedMap, merge
from simulator.slam.odometry import OdometryModel
from simulator.slam.pose import Points, Poses, between, compose, fit_motion, transform
from simulator.slam.pose_graph import Edge, PoseGraph, Sighting
from simulator.slam.robot_map import RobotMap

_LASER = Laser(beams=361, range_m=30.0, noise_m=0.015)
_MODEL = OdometryModel()


@dataclass(frozen=True, slots=True, eq=False)
class LotRun:
    """One run."""

    merged: MergedMap
    poles_m: Points
    """(n, 2): truth"""
    tracks: dict[str, Poses]
    """robot -> (nodes, 3): truth"""
    error_m: dict[str, float]
    """robot -> root mean square error of its poses in the joint frame"""
    odometry_error_m: dict[str, float]
    pole_error_m: float
    """root mean square distance of joint landmarks from the nearest pole"""
    accepted: int
    wrong: int


def parking_lot(random: np.random.Generator) -> tuple[OccupancyGrid, list[Disc], Points]:
    """70 x 50 m with rows of parked cars and 30 poles of 15 cm."""
    cells = np.zeros((500, 700), dtype=np.int8)
    cells[:3] = cells[-3:] = 100
    cells[:, :3] = cells[:, -3:] = 100
    for row_m in (14.0, 34.0):
        for place in range(16):
            if random.random() < 0.6:
                x, y = 6.0 + 3.8 * place, row_m
                cells[int(10 * y) : int(10 * (y + 4.2)), int(10 * x) : int(10 * (x + 1.8))] = 100
    grid = OccupancyGrid(cells, 0.1, (0.0, 0.0))
    poles: list[tuple[float, float]] = []
    while len(poles) < 30:
        x, y = random.uniform(3.0, 67.0), random.uniform(3.0, 47.0)
        block = cells[int(10 * y) - 12 : int(10 * y) + 13, int(10 * x) - 12 : int(10 * x) + 13]
        if not block.any() and all(math.dist((x, y), pole) > 3.0 for pole in poles):
            poles.append((x, y))
    return grid, [(x, y, 0.075) for x, y in poles], np.array(poles)


def run_once(seed: int, robots: int = 3) -> LotRun:
    """Each robot drives its own tour and does its own SLAM; then all maps are merged."""
    random = np.random.default_rng(seed)
    grid, discs, poles = parking_lot(random)
    surveyor = Surveyor(grid, discs)
    maps, tracks, odometry = [], {}, {}
    for number in range(robots):
        name = f"robot_{number + 1}"
        corners = [
            (random.uniform(4.0, 9.0), random.uniform(4.0, 9.0)),
            (random.uniform(58.0, 66.0), random.uniform(4.0, 9.0)),
            (random.uniform(58.0, 66.0), random.uniform(24.0, 29.0)),
            (random.uniform(4.0, 9.0), random.uniform(24.0, 29.0)),
            (random.uniform(4.0, 9.0), random.uniform(41.0, 46.0)),
            (random.uniform(58.0, 66.0), random.uniform(41.0, 46.0)),
        ]
        tour = [corners[(number + place) % len(corners)] for place in range(len(corners) + 1)]
        path = surveyor.path(tour)
        drive = surveyor.drive(path, _LASER, OdometryNoise(), random)
        robot_map, nodes = landmark_slam(name, drive.scans)
        maps.append(robot_map)
        tracks[name] = path[nodes]
        odometry[name] = compose(
            path[0], np.array([drive.scans[place].odometry for place in nodes])
        )
    alignments, wrong = align_all(maps, random, {name: track[0] for name, track in tracks.items()})
    merged = merge(maps, alignments, BackEndParameters(kernel="huber"))
    return _judged(merged, poles, tracks, odometry, accepted=len(alignments), wrong=wrong)


def landmark_slam(name: str, scans: object) -> tuple[RobotMap, list[int]]:
    """Single-robot landmark SLAM: nodes every metre, poles associated by nearness."""
    graph = PoseGraph({0: np.zeros(3)})
    mapper = LandmarkMapper(LandmarkParameters(gate_m=1.0))
    nodes: list[int] = []
    last = np.zeros(3)
    for place, scan in enumerate(scans):  # type: ignore[arg-type, var-annotated]
        motion = between(last, scan.odometry)
        if nodes and np.hypot(motion[0], motion[1]) < 1.0 and abs(motion[2]) < 0.5:
            continue
        key = len(nodes)
        if nodes:
            graph.poses[key] = compose(graph.poses[key - 1], motion)
            graph.edges.append(Edge(key - 1, key, motion, _MODEL.information(motion)))
        nodes.append(place)
        last = scan.odometry
        seen = detect_poles(scan, PoleParameters(largest_diameter_m=0.5, range_m=20.0))
        for number, at in zip(mapper.add(graph.poses[key], seen).tolist(), seen, strict=True):
            graph.landmarks.setdefault(number, transform(graph.poses[key], at[None])[0])
            graph.sightings.append(Sighting(key, number, at, np.eye(2) / 0.06**2))
        if key % 20 == 19:
            graph = optimise(graph, BackEndParameters(kernel="huber")).graph
    sure = _seen_often(graph)
    return RobotMap(name, optimise(sure, BackEndParameters(kernel="huber")).graph), nodes


def _seen_often(graph: PoseGraph, least: int = 4) -> PoseGraph:
    numbers = [sighting.landmark for sighting in graph.sightings]
    sure = {number for number in set(numbers) if numbers.count(number) >= least}
    return PoseGraph(
        graph.poses,
        graph.edges,
        {key: at for key, at in graph.landmarks.items() if key in sure},
        [sighting for sighting in graph.sightings if sighting.landmark in sure],
    )


def align_all(
    maps: list[RobotMap], random: np.random.Generator, starts: dict[str, Poses]
) -> tuple[list[Alignment], int]:
    """Algorithm 4 over all pairs; how many of those accepted are wrong."""
    alignments, wrong = [], 0
    for second in range(1, len(maps)):
        for first in range(second):
            a, b = maps[first], maps[second]
            parameters = AlignmentParameters(match_m=0.7)
            found = align_landmarks(
                a.graph.landmark_positions(), b.graph.landmark_positions(), random, parameters
            )
            if found is None or not found.accepted:
                continue
            keys_a, keys_b = sorted(a.graph.landmarks), sorted(b.graph.landmarks)
            same = tuple((keys_a[i], keys_b[j]) for i, j in found.matches.tolist())
            alignments.append(Alignment(a.robot, b.robot, found.motion, (), same))
            away = between(between(starts[a.robot], starts[b.robot]), found.motion)
            wrong += bool(np.hypot(away[0], away[1]) > 2.0 or abs(away[2]) > 0.1)
    return alignments, wrong


def _judged(
    merged: MergedMap,
    poles: Points,
    tracks: dict[str, Poses],
    odometry: dict[str, Poses],
    *,
    accepted: int,
    wrong: int,
) -> LotRun:
    """Errors in one common frame, fitted to all robots' true tracks together."""
    names = list(merged.robot_maps)
    estimate = np.concatenate([merged.robot_maps[n].graph.trajectory()[:, :2] for n in names])
    truth = np.concatenate([tracks[name][:, :2] for name in names])
    motion = fit_motion(estimate, truth)
    errors, drift = {}, {}
    for name in names:
        found = transform(motion, merged.robot_maps[name].graph.trajectory()[:, :2])
        errors[name] = float(np.sqrt(np.mean(np.sum((found - tracks[name][:, :2]) ** 2, axis=1))))
        away = odometry[name][:, :2] - tracks[name][:, :2]
        drift[name] = float(np.sqrt(np.mean(np.sum(away**2, axis=1))))
    landmarks = np.concatenate(
        [merged.robot_maps[name].graph.landmark_positions() for name in names]
    )
    found = transform(motion, landmarks)
    apart = np.linalg.norm(found[:, None] - poles[None], axis=2).min(axis=1)
    near = apart[apart < 2.0]
    return LotRun(
        merged, poles, tracks, errors, drift, float(np.sqrt(np.mean(near**2))), accepted, wrong
    )
