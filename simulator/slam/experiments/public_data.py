"""Public data: pose graphs, laser logs cut into robots, five real robots among landmarks.

Everything is read from a folder that is not part of the project; what is absent is left out with a
sentence. Reference values are gtsam's optimum, the corrected logs, and motion capture.
"""

from __future__ import annotations

import gzip
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np

from simulator.slam.back_end import BackEndParameters, optimise
from simulator.slam.carmen import read_carmen
from simulator.slam.experiments.statistics import table
from simulator.slam.front_end import build_map
from simulator.slam.g2o import read_g2o
from simulator.slam.grid_front_end import GridFrontEndParameters, merge_grid_maps
from simulator.slam.landmark_alignment import AlignmentParameters, align_landmarks
from simulator.slam.merging import MergedMap
from simulator.slam.odometry import OdometryModel
from simulator.slam.pose import Points, Poses, between, compose, fit_motion, transform, wrap
from simulator.slam.pose_graph import (
    Edge,
    PoseGraph,
    Sighting,
    absolute_trajectory_error_m,
    chi2,
)
from simulator.slam.range_scan import RangeScan
from simulator.slam.robot_map import RobotMap
from simulator.slam.triangles import TriangleParameters

REFERENCE_CHI2 = {"intel.g2o": 546.46, "csail.g2o": 39.0, "manhattanOlson3500.g2o": 146.08}
"""optima that gtsam 4.3's Levenberg-Marquardt reaches from the files' own poses"""


def pose_graphs(folder: Path) -> str:
    """Optima beside the reference, and the trajectory's error where the truth is known."""
    rows = []
    for name, reference in REFERENCE_CHI2.items():
        if not (folder / name).is_file():
            continue
        found = optimise(read_g2o(folder / name))
        truth = folder / f"{Path(name).stem}_groundtruth.txt"
        error = "-"
        if truth.is_file():
            true = read_g2o(truth).trajectory()
            error = f"{absolute_trajectory_error_m(found.graph.trajectory(), true):.3f}"
        rows.append(
            [
                name,
                len(found.graph.poses),
                len(found.graph.edges),
                f"{found.chi2_before:.0f}",
                f"{found.chi2_after:.2f}",
                reference,
                f"{100 * (found.chi2_after / reference - 1):+.2f} %",
                error,
            ]
        )
    heads = ["graph", "poses", "edges", "chi2 before", "after", "reference", "apart", "ATE [m]"]
    return table(heads, rows)


def split_log(
    raw: Path, corrected: Path, parts: Sequence[tuple[float, float]], seed: int = 0
) -> tuple[str, MergedMap]:
    """One log cut into several robots' (shares of its scans), each mapped alone, then merged."""
    scans = read_carmen(raw, 20.0)
    reference = {_content(scan): scan.odometry for scan in read_carmen(corrected, 20.0)}
    random = np.random.default_rng(seed)
    maps = []
    for number, (begin, end) in enumerate(parts):
        share = scans[int(begin * len(scans)) : int(end * len(scans))]
        robot_map = build_map(f"robot_{number + 1}", share)
        # Nobody knows where the others began.
        frame = np.array([*random.uniform(-50.0, 50.0, 2), random.uniform(-np.pi, np.pi)])
        maps.append(robot_map.with_graph(robot_map.graph.moved(frame)))
    merged, tried = merge_grid_maps(maps, random, GridFrontEndParameters())
    together, truths = [], []
    rows = []
    for robot_map in maps:
        joint = merged.robot_maps.get(robot_map.robot)
        known = [
            (key, reference[_content(robot_map.scans[key])])
            for key in sorted(robot_map.scans)
            if _content(robot_map.scans[key]) in reference
        ]
        truth = np.array([pose for _, pose in known])
        alone = np.array([robot_map.graph.poses[key] for key, _ in known])
        rows.append(
            [
                robot_map.robot,
                len(robot_map.scans),
                f"{absolute_trajectory_error_m(alone, truth):.3f}",
                "merged" if joint is not None else "alone",
            ]
        )
        if joint is not None:
            together.append(np.array([joint.graph.poses[key] for key, _ in known]))
            truths.append(truth)
    error = absolute_trajectory_error_m(np.concatenate(together), np.concatenate(truths))
    candidates = sum(len(found.candidates) for found in tried)
    text = table(["robot", "nodes", "ATE alone [m]", "joint graph"], rows)
    return (
        f"{raw.name}: {len(merged.robot_maps)} of {len(maps)} robots merged by "
        f"{len(merged.edges)} constraints of {candidates} candidates; joint ATE {error:.3f} m in "
        f"one frame\n\n{text}",
        merged,
    )


def _content(scan: RangeScan) -> bytes:
    return np.round(scan.ranges_m[:60], 2).tobytes()


def read_mrclam(folder: Path, robot: int, period_s: float = 1.0) -> tuple[RobotMap, Poses, Points]:
    """A robot of the UTIAS data: odometry and range-bearing sightings of the 15 landmarks.

    Barcodes tell landmarks apart within a robot's own map; across robots only geometry is used.

    Returns:
        the optimised map, true poses of the nodes, true positions of its landmarks by key.
    """
    codes = {int(code): int(subject) for subject, code in _columns(folder / "Barcodes.dat.gz")}
    odometry = _columns(folder / f"Robot{robot}_Odometry.dat.gz")
    truth = _columns(folder / f"Robot{robot}_Groundtruth.dat.gz")
    seen = _columns(folder / f"Robot{robot}_Measurement.dat.gz")
    begin, end = max(odometry[0, 0], truth[0, 0]), min(odometry[-1, 0], truth[-1, 0])
    times = np.arange(begin, end, period_s)
    pose = np.zeros(3)
    graph, model = PoseGraph({0: pose}), OdometryModel(metre_per_metre=0.1, radian_per_radian=0.15)
    for key in range(1, len(times)):
        motion = _integrated(odometry, times[key - 1], times[key])
        graph.poses[key] = compose(graph.poses[key - 1], motion)
        graph.edges.append(Edge(key - 1, key, motion, model.information(motion)))
    for time_s, code, reach, bearing in seen:
        subject = codes.get(int(code), 0)
        key = int(np.searchsorted(times, time_s) - 1)
        if subject < 6 or not 0 <= key < len(times):
            continue
        nearest = key if time_s - times[key] < 0.5 * period_s else min(key + 1, len(times) - 1)
        back = _integrated(odometry, min(times[nearest], time_s), max(times[nearest], time_s))
        at = np.array([reach * np.cos(bearing), reach * np.sin(bearing)])
        if time_s >= times[nearest]:
            at = transform(back, at[None])[0]
        graph.landmarks.setdefault(subject, transform(graph.poses[nearest], at[None])[0])
        graph.sightings.append(Sighting(nearest, subject, at, np.eye(2) / 0.15**2))
    found = optimise(graph, BackEndParameters(kernel="huber")).graph
    true = np.stack([np.interp(times, truth[:, 0], truth[:, axis]) for axis in (1, 2)], axis=1)
    heading = np.interp(times, truth[:, 0], np.unwrap(truth[:, 3]))
    marks = {int(row[0]): row[1:3] for row in _columns(folder / "Landmark_Groundtruth.dat.gz")}
    where = np.array([marks[key] for key in sorted(found.landmarks)])
    return RobotMap(f"robot_{robot}", found), np.column_stack([true, wrap(heading)]), where


def _columns(path: Path) -> np.ndarray:
    with gzip.open(path, "rt", encoding="utf-8") as lines:
        return np.atleast_2d(np.loadtxt(lines, comments="#"))


def _integrated(odometry: np.ndarray, begin_s: float, end_s: float) -> Poses:
    """Motion (3,) between two times from forward and angular velocity."""
    first, last = np.searchsorted(odometry[:, 0], (begin_s, end_s))
    edges = np.concatenate([[begin_s], odometry[first:last, 0], [end_s]])
    rows = np.clip(np.arange(first - 1, last), 0, len(odometry) - 1)
    pose = np.zeros(3)
    for step_s, (_, speed, turn) in zip(np.diff(edges), odometry[rows], strict=True):
        pose = compose(pose, np.array([speed * step_s, 0.0, turn * step_s]))
    return pose


def mrclam(folder: Path, seed: int = 0) -> str:
    """Five robots: each against motion capture alone, then every two by their landmark maps."""
    robots = [read_mrclam(folder, number) for number in range(1, 6)]
    rows = []
    for robot_map, truth, marks in robots:
        track = absolute_trajectory_error_m(robot_map.graph.trajectory(), truth)
        positions = robot_map.graph.landmark_positions()
        motion = fit_motion(positions, marks)
        apart = np.linalg.norm(transform(motion, positions) - marks, axis=1)
        rows.append(
            [
                robot_map.robot,
                len(truth),
                len(positions),
                f"{track:.3f}",
                f"{np.sqrt(np.mean(apart**2)):.3f}",
            ]
        )
    random = np.random.default_rng(seed)
    # The arena is 15 m wide and landmarks stand in groups: nearer matches than in a park.
    parameters = AlignmentParameters(
        match_m=0.45,
        reach_m=0.4,
        verified=10,
        triangles=TriangleParameters(candidates=20, neighbours=8),
    )
    right, accepted, wrong, errors = 0, 0, 0, []
    pairs = list(combinations(robots, 2))
    for (a, _, _), (b, _, _) in pairs:
        one, other = a.graph.landmark_positions(), b.graph.landmark_positions()
        found = align_landmarks(one, other, random, parameters)
        if found is None:
            continue
        # The motion that the landmarks' identities give.
        away = between(fit_motion(other, one), found.motion)
        errors.append(float(np.hypot(away[0], away[1])))
        good = errors[-1] < 0.3 and abs(away[2]) < 0.1
        right += good
        accepted += found.accepted
        wrong += found.accepted and not good
    heads = ["robot", "nodes", "landmarks", "ATE [m]", "landmark error [m]"]
    mean = float(np.mean(errors)) if errors else float("nan")
    return (
        f"{table(heads, rows)}\n\n{right} of {len(pairs)} motions between two robots' maps found "
        f"right without identities, {mean:.3f} m from the one that identities give; {accepted} "
        f"accepted, {wrong} wrongly: fifteen landmarks in groups, 0.1 to 0.2 m off, can be brought "
        "together so well by chance"
    )


def victoria_park(path: Path) -> str:
    """The pose graph with trunks, optimised piece by piece so that the start is good enough."""
    graph = read_g2o(path)
    found = optimised_in_pieces(graph)
    marks = len(found.landmarks)
    sightings = len(found.sightings)
    extent = np.ptp(found.landmark_positions(), axis=0)
    return (
        f"{len(found.poses)} poses, {marks} trunks, {sightings} sightings; chi2 "
        f"{chi2(graph):.3g} -> {chi2(found):.1f}; extent {extent[0]:.0f} x {extent[1]:.0f} m"
    )


def optimised_in_pieces(graph: PoseGraph, piece: int = 400) -> PoseGraph:
    """Optimises ever longer beginnings: each new piece starts from the corrected end of the last.

    Batch optimisation from dead reckoning ends in a local optimum where loops are long.
    """
    keys = sorted(graph.poses)
    parameters = BackEndParameters(kernel="huber", max_iterations=30)
    done = PoseGraph({keys[0]: graph.poses[keys[0]]})
    for begin in range(0, len(keys), piece):
        known = set(keys[: begin + piece])
        edges = [e for e in graph.edges if e.start in known and e.end in known]
        sightings = [s for s in graph.sightings if s.pose in known]
        poses = dict(done.poses)
        for edge in sorted(edges, key=lambda e: e.end):
            if edge.end not in poses and edge.start in poses:
                poses[edge.end] = compose(poses[edge.start], edge.measurement)
        landmarks = dict(done.landmarks)
        for sighting in sightings:
            if sighting.landmark not in landmarks:
                at = transform(poses[sighting.pose], sighting.position_m[None])[0]
                landmarks[sighting.landmark] = at
        done = optimise(PoseGraph(poses, edges, landmarks, sightings), parameters).graph
    return optimise(done, replace(parameters, kernel="none")).graph
