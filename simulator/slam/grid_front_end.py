"""Constraints between graphs from grid maps: one robot localized in another's map (Algorithm 3).

The lines of the algorithm are named at the code. Beyond the thesis: the pose that the particle
filter finds is refined by scan matching, all d scans of a sequence are held against the map and not
only the last, and consensus is RANSAC or pairwise consistency.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simulator.occupancy_grid import OccupancyGrid
from simulator.slam.back_end import BackEndParameters, joint_covariance
from simulator.slam.consensus import (
    ConsensusMethod,
    InterEdge,
    RansacParameters,
    largest_clique,
    pairwise_consistency,
    ransac_motions,
    relative_spread,
)
from simulator.slam.localization import (
    LocalizationParameters,
    SensorField,
    localize,
    scan_points,
)
from simulator.slam.merging import Alignment, MergedMap, merge
from simulator.slam.pose import Poses, between, compose, fit_motion, inverse, transform
from simulator.slam.range_scan import RangeScan
from simulator.slam.robot_map import RobotMap, grid_of_scans, map_with_known_poses
from simulator.slam.scan_matching import ScanMatchParameters, match, surfaces


@dataclass(frozen=True, slots=True)
class GridFrontEndParameters:
    """Algorithm 3's constants and what goes beyond it."""

    sequence: int = 40
    """d: scans of a localization"""
    stride: int = 8
    """nodes by which a sequence that did not converge is moved on"""
    least_constraints: int = 3
    method: ConsensusMethod = "pcm"
    ransac: RansacParameters = field(default_factory=RansacParameters)
    consistency_gate: float = 11.34
    systematic: float = 0.04
    """share of the distance between two nodes by which a graph may be too short or too long:
    systematic errors are not in its covariances"""
    resolution_m: float = 0.1
    reach_m: float = 15.0
    """parts of beams beyond are not drawn into the map"""
    threshold_quantile: float = 0.05
    threshold_share: float = 0.75
    """l_min is that share of the quantile of the robot's own likelihoods: the other robot saw the
    place at another time, or on another floor"""
    surroundings_m: float = 6.0
    """nodes so near make up what a found pose is refined against"""
    localization: LocalizationParameters = field(default_factory=LocalizationParameters)
    matching: ScanMatchParameters = field(default_factory=ScanMatchParameters)
    back_end: BackEndParameters = field(default_factory=lambda: BackEndParameters(kernel="huber"))


@dataclass(frozen=True, slots=True, eq=False)
class GridAlignment:
    """What localizing one robot in another's map came to."""

    alignment: Alignment | None
    """None if fewer than the least number of constraints agree"""
    candidates: tuple[InterEdge, ...]
    """C_i before the consensus"""
    chosen: NDArray[np.intp]
    """indices of the candidates that agree"""
    likelihoods: NDArray[np.float64]
    """(converged,): mean likelihood of each sequence that converged"""
    threshold: float
    """l_min"""
    sequences: int
    """localizations tried"""


@dataclass(frozen=True, slots=True, eq=False)
class ReferenceMap:
    """A robot's map prepared for others to be localized in (lines 1 and 2)."""

    robot_map: RobotMap
    grid: OccupancyGrid
    sensor_field: SensorField
    positions_m: NDArray[np.float64]
    """(n, 2): nodes with scans"""
    keys: NDArray[np.int64]


def reference_map(
    robot_map: RobotMap, parameters: GridFrontEndParameters | None = None
) -> ReferenceMap:
    """Line 2: mapping with known poses."""
    parameters = parameters or GridFrontEndParameters()
    grid = map_with_known_poses([robot_map], parameters.resolution_m, parameters.reach_m)
    keys = np.array(sorted(robot_map.scans), dtype=np.int64)
    positions = np.array([robot_map.graph.poses[int(key)][:2] for key in keys])
    sensor_field = SensorField(grid, parameters.localization)
    return ReferenceMap(robot_map, grid, sensor_field, positions, keys)


def learned_threshold(robot_map: RobotMap, parameters: GridFrontEndParameters) -> float:
    """l_min: what the sensor model says of the robot's scans in its own map.

    Half of the scans, in blocks, draw the map, the other half is held against it.
    """
    posed = robot_map.posed_scans()
    drawn = [entry for place, entry in enumerate(posed) if (place // 5) % 2 == 0]
    held = [entry for place, entry in enumerate(posed) if (place // 5) % 2 == 1]
    if not held:
        return 0.0
    grid = grid_of_scans(drawn, parameters.resolution_m, parameters.reach_m)
    sensor_field = SensorField(grid, parameters.localization)
    likelihoods = [_likelihood(sensor_field, pose, scan, parameters) for pose, scan in held]
    known = np.array([value for value in likelihoods if value is not None])
    if len(known) == 0:
        return 0.0
    return float(parameters.threshold_share * np.quantile(known, parameters.threshold_quantile))


def _likelihood(
    sensor_field: SensorField, pose: Poses, scan: RangeScan, parameters: GridFrontEndParameters
) -> float | None:
    points = scan_points(scan, parameters.localization.beams)
    points = points[np.hypot(points[:, 0], points[:, 1]) < parameters.reach_m]
    if len(points) < 5:
        return None
    return float(np.exp(sensor_field.mean_log_likelihood(pose[None], points)[0]))


def align_grid_maps(
    reference: ReferenceMap,
    other: RobotMap,
    random: np.random.Generator,
    parameters: GridFrontEndParameters | None = None,
) -> GridAlignment:
    """Lines 4 to 17: constraints between the reference graph and another one."""
    parameters = parameters or GridFrontEndParameters()
    threshold = learned_threshold(other, parameters)
    keys = sorted(other.scans)
    posed = other.posed_scans()
    candidates: list[InterEdge] = []
    likelihoods: list[float] = []
    k = tried = 0
    while k + parameters.sequence <= len(posed):  # line 5
        sequence = posed[k : k + parameters.sequence]
        tried += 1
        found = localize(reference.sensor_field, sequence, random, parameters.localization)
        if found is None:  # line 7
            k += parameters.stride
            continue
        k += parameters.sequence  # line 8
        likelihood = _sequence_likelihood(reference, sequence, found.pose, parameters)  # line 9
        likelihoods.append(likelihood)
        if likelihood <= threshold:  # line 10
            continue
        edge = _constraint(
            reference,
            other,
            keys[k - 1],
            pose=found.pose,
            covariance=found.covariance,
            parameters=parameters,
        )
        if edge is not None:
            candidates.append(edge)  # line 13
    chosen = _consensus(reference.robot_map, other, candidates, random, parameters)  # line 17
    alignment = None
    if len(chosen) >= parameters.least_constraints:
        edges = tuple(candidates[place] for place in chosen)
        motion = _middle_motion(_motions(reference.robot_map, other, edges), edges, other)
        alignment = Alignment(reference.robot_map.robot, other.robot, motion, edges)
    return GridAlignment(
        alignment, tuple(candidates), chosen, np.array(likelihoods), threshold, tried
    )


def _sequence_likelihood(
    reference: ReferenceMap,
    sequence: Sequence[tuple[Poses, RangeScan]],
    pose: Poses,
    parameters: GridFrontEndParameters,
) -> float:
    """Eq. 4.13, also over the scans that led to the last one, placed by the robot's own graph."""
    last = sequence[-1][0]
    values = [
        _likelihood(reference.sensor_field, compose(pose, between(last, own)), scan, parameters)
        for own, scan in sequence[-parameters.sequence // 2 :]
    ]
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else 0.0


def _constraint(
    reference: ReferenceMap,
    other: RobotMap,
    key: int,
    *,
    pose: Poses,
    covariance: NDArray[np.float64],
    parameters: GridFrontEndParameters,
) -> InterEdge | None:
    """Lines 11 and 12: from the nearest node of the reference graph to the localized one."""
    apart = np.linalg.norm(reference.positions_m - pose[:2], axis=1)
    nearest = int(reference.keys[int(np.argmin(apart))])  # eq. 4.11
    graph = reference.robot_map.graph
    around = [
        (graph.poses[int(node)], reference.robot_map.scans[int(node)])
        for node in reference.keys[apart < parameters.surroundings_m]
    ]
    if not around:
        return None
    prior = np.asarray(np.linalg.inv(covariance + np.diag([1e-3, 1e-3, 1e-4])), dtype=np.float64)
    found = match(
        surfaces(around), other.scans[key], pose, (0.4, 0.15), parameters.matching, prior=prior
    )
    if found is None:
        return None
    measurement = between(graph.poses[nearest], found.pose)  # eq. 4.12
    information = found.information + prior
    return InterEdge(reference.robot_map.robot, nearest, other.robot, key, measurement, information)


def _motions(a: RobotMap, b: RobotMap, edges: Sequence[InterEdge]) -> Poses:
    """(m, 3): where each constraint puts the second robot's frame in the first's."""
    at = np.array([compose(a.graph.poses[e.node_a], e.measurement) for e in edges]).reshape(-1, 3)
    own = np.array([b.graph.poses[e.node_b] for e in edges]).reshape(-1, 3)
    return compose(at, inverse(own))


def _middle_motion(motions: Poses, edges: Sequence[InterEdge], b: RobotMap) -> Poses:
    """The hypothesis that brings all constraints' nodes nearest to where they were measured."""
    own = np.array([b.graph.poses[edge.node_b][:2] for edge in edges])
    at = np.array(
        [transform(motion, place[None])[0] for motion, place in zip(motions, own, strict=True)]
    )
    if np.ptp(own, axis=0).max() < 3.0:
        return np.asarray(motions[len(motions) // 2])
    return fit_motion(own, at)


def _consensus(
    a: RobotMap,
    b: RobotMap,
    edges: Sequence[InterEdge],
    random: np.random.Generator,
    parameters: GridFrontEndParameters,
) -> NDArray[np.intp]:
    """Indices of the constraints that agree."""
    if len(edges) == 0:
        return np.zeros(0, dtype=np.intp)
    if parameters.method == "ransac":
        own = np.array([b.graph.poses[edge.node_b][:2] for edge in edges])
        return ransac_motions(_motions(a, b, edges), own, random, parameters.ransac)
    keys_a, keys_b = [e.node_a for e in edges], [e.node_b for e in edges]
    poses_a = np.array([a.graph.poses[key] for key in keys_a])
    poses_b = np.array([b.graph.poses[key] for key in keys_b])
    consistent = pairwise_consistency(
        edges,
        poses_a,
        poses_b,
        _spread(a, keys_a, poses_a, parameters.systematic),
        _spread(b, keys_b, poses_b, parameters.systematic),
        gate=parameters.consistency_gate,
    )
    return largest_clique(consistent)


def _spread(
    robot_map: RobotMap, keys: Sequence[int], poses: Poses, systematic: float
) -> NDArray[np.float64]:
    """(m, m, 3, 3): covariance of relative poses, with a systematic error of lengths."""
    spread = relative_spread(_covariance(robot_map, keys), poses)
    apart = np.linalg.norm(poses[:, None, :2] - poses[None, :, :2], axis=2)
    spread[..., 0, 0] += (systematic * apart) ** 2
    spread[..., 1, 1] += (systematic * apart) ** 2
    return spread


def _covariance(robot_map: RobotMap, keys: Sequence[int]) -> NDArray[np.float64]:
    """(3 m, 3 m), also where a node is asked for twice."""
    unique = sorted(set(keys))
    joint = joint_covariance(robot_map.graph, unique)
    place = {key: index for index, key in enumerate(unique)}
    rows = np.concatenate([3 * place[key] + np.arange(3) for key in keys])
    return np.asarray(joint[np.ix_(rows, rows)])


def merge_grid_maps(
    robot_maps: Sequence[RobotMap],
    random: np.random.Generator,
    parameters: GridFrontEndParameters | None = None,
) -> tuple[MergedMap, tuple[GridAlignment, ...]]:
    """Algorithm 3: the joint graph of all robots (or floors) that can be localized in one another.

    The first map is the reference; a robot that cannot be localized in it is tried in those that
    could be.
    """
    parameters = parameters or GridFrontEndParameters()
    waiting = list(robot_maps[1:])
    references = [robot_maps[0]]
    tried: list[GridAlignment] = []
    alignments: list[Alignment] = []
    while references and waiting:
        reference = reference_map(references.pop(0), parameters)
        for other in list(waiting):
            found = align_grid_maps(reference, other, random, parameters)
            tried.append(found)
            if found.alignment is not None:
                alignments.append(found.alignment)
                waiting.remove(other)
                references.append(other)
    return merge(robot_maps, alignments, parameters.back_end), tuple(tried)  # line 19
