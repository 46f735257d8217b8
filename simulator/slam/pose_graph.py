"""Pose graphs: what a front end builds and a back end optimises (thesis 4.2, eq. 4.1-4.3).

Nodes are poses and landmarks with numbers as keys, each kind in a key space of its own; edges are
relative measurements with information matrices. The graph holds no sensor readings.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from simulator.slam.pose import Points, Poses, between, compose, fit_motion, transform, wrap

EdgeKind = Literal["odometry", "loop", "inter"]
"""consecutive poses, a place seen again, or a constraint between the graphs of two robots"""


@dataclass(frozen=True, slots=True)
class Edge:
    """The pose of `end` as measured from `start`."""

    start: int
    end: int
    measurement: Poses
    """(3,): x [m], y [m], heading [rad] in the frame of `start`"""
    information: NDArray[np.float64]
    """(3, 3): inverse covariance of the measurement"""
    kind: EdgeKind = "odometry"


@dataclass(frozen=True, slots=True)
class Sighting:
    """The position of a landmark as measured from a pose."""

    pose: int
    landmark: int
    position_m: Points
    """(2,) in the frame of the pose"""
    information: NDArray[np.float64]
    """(2, 2): inverse covariance of the position"""


@dataclass(slots=True)
class PoseGraph:
    """G = (V, E) of eq. 4.1, with landmarks."""

    poses: dict[int, Poses] = field(default_factory=dict)
    edges: list[Edge] = field(default_factory=list)
    landmarks: dict[int, Points] = field(default_factory=dict)
    sightings: list[Sighting] = field(default_factory=list)

    def trajectory(self) -> Poses:
        """(n, 3): poses in the order of their keys."""
        return np.array([self.poses[key] for key in sorted(self.poses)]).reshape(-1, 3)

    def landmark_positions(self) -> Points:
        """(n, 2): landmarks in the order of their keys."""
        return np.array([self.landmarks[key] for key in sorted(self.landmarks)]).reshape(-1, 2)

    def moved(self, motion: Poses) -> PoseGraph:
        """The same graph in another frame: each pose composed after `motion`."""
        poses = {key: compose(motion, pose) for key, pose in self.poses.items()}
        landmarks = {key: transform(motion, at[None])[0] for key, at in self.landmarks.items()}
        return replace(self, poses=poses, landmarks=landmarks)

    def renumbered(self, first_pose: int, first_landmark: int) -> PoseGraph:
        """The same graph with keys shifted, so that graphs can be put side by side."""
        return PoseGraph(
            {key + first_pose: pose for key, pose in self.poses.items()},
            [replace(e, start=e.start + first_pose, end=e.end + first_pose) for e in self.edges],
            {key + first_landmark: at for key, at in self.landmarks.items()},
            [
                replace(s, pose=s.pose + first_pose, landmark=s.landmark + first_landmark)
                for s in self.sightings
            ],
        )

    def check(self) -> None:
        """Looks at the graph before an optimiser does.

        Raises:
            ValueError: an edge names a node that is not there, an information matrix is not
                symmetric with a positive diagonal, or no constraint connects some nodes with the
                others.
        """
        for place, (keys, information) in enumerate(_constraints(self)):
            for key, nodes, kind in keys:
                if key not in nodes:
                    raise ValueError(f"constraint {place} names the unknown {kind} {key}")
            if not np.allclose(information, information.T) or np.any(np.diag(information) <= 0):
                raise ValueError(
                    f"constraint {place} ({', '.join(str(key) for key, *_ in keys)}): its "
                    "information matrix must be symmetric with a positive diagonal"
                )
        parts = self._parts()
        if parts > 1:
            raise ValueError(
                f"the pose graph falls into {parts} parts that no constraint connects, so it has "
                "no unique optimum: add constraints between them, or optimise each on its own"
            )

    def _parts(self) -> int:
        """Number of connected components of poses and landmarks."""
        nodes = [("pose", key) for key in self.poses] + [("mark", key) for key in self.landmarks]
        place = {node: index for index, node in enumerate(nodes)}
        ends = [(place["pose", e.start], place["pose", e.end]) for e in self.edges]
        ends += [(place["pose", s.pose], place["mark", s.landmark]) for s in self.sightings]
        pairs = np.array(ends, dtype=np.int64).reshape(-1, 2)
        links = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(nodes), len(nodes)))
        parts, _ = connected_components(links, directed=False)
        return int(parts)


_Keys = list[tuple[int, dict[int, NDArray[np.float64]], str]]


def _constraints(graph: PoseGraph) -> Iterable[tuple[_Keys, NDArray[np.float64]]]:
    for edge in graph.edges:
        ends: _Keys = [(edge.start, graph.poses, "pose"), (edge.end, graph.poses, "pose")]
        yield ends, edge.information
    for sighting in graph.sightings:
        at: _Keys = [
            (sighting.pose, graph.poses, "pose"),
            (sighting.landmark, graph.landmarks, "landmark"),
        ]
        yield at, sighting.information


def edge_errors(graph: PoseGraph) -> NDArray[np.float64]:
    """(edges,): r^T Omega r of every edge (eq. 4.6-4.9), the residual in the measured frame."""
    if not graph.edges:
        return np.zeros(0)
    start = np.array([graph.poses[edge.start] for edge in graph.edges])
    end = np.array([graph.poses[edge.end] for edge in graph.edges])
    measured = np.array([edge.measurement for edge in graph.edges])
    information = np.array([edge.information for edge in graph.edges])
    residual = between(measured, between(start, end))
    return np.asarray(np.einsum("ni,nij,nj->n", residual, information, residual))


def sighting_errors(graph: PoseGraph) -> NDArray[np.float64]:
    """(sightings,): squared Mahalanobis distance of range and bearing from those measured.

    Information of the position is turned into information of bearing and range at the measured
    point, the model that the back end optimises.
    """
    if not graph.sightings:
        return np.zeros(0)
    poses = np.array([graph.poses[sighting.pose] for sighting in graph.sightings])
    at = np.array([graph.landmarks[sighting.landmark] for sighting in graph.sightings])
    seen = between(poses, np.concatenate([at, np.zeros((len(at), 1))], axis=1))
    measured = np.array([sighting.position_m for sighting in graph.sightings])
    errors = np.array(
        [
            wrap(np.arctan2(seen[:, 1], seen[:, 0]) - np.arctan2(measured[:, 1], measured[:, 0])),
            np.hypot(seen[:, 0], seen[:, 1]) - np.hypot(measured[:, 0], measured[:, 1]),
        ]
    ).T
    information = np.array([polar_information(sighting) for sighting in graph.sightings])
    return np.asarray(np.einsum("ni,nij,nj->n", errors, information, errors))


def polar_information(sighting: Sighting) -> NDArray[np.float64]:
    """(2, 2): the sighting's information in bearing [rad] and range [m]."""
    x, y = sighting.position_m
    reach = float(np.hypot(x, y))
    turned = np.array([[-y, x / reach], [x, y / reach]])
    return np.asarray(turned.T @ sighting.information @ turned)


def chi2(graph: PoseGraph) -> float:
    """The sum that a back end minimises (eq. 4.9)."""
    return float(edge_errors(graph).sum() + sighting_errors(graph).sum())


def dead_reckoning(graph: PoseGraph) -> PoseGraph:
    """Poses anew from the first pose and the chain of odometry edges alone."""
    poses = dict(graph.poses)
    chain = {e.start: e for e in graph.edges if e.kind == "odometry"}
    for key in sorted(poses):
        edge = chain.get(key)
        if edge is not None and edge.end > key:
            poses[edge.end] = compose(poses[key], edge.measurement)
    return replace(graph, poses=poses)


def absolute_trajectory_error_m(estimate: Poses, truth: Poses) -> float:
    """Root mean square distance of positions after the best rigid alignment (ATE).

    Sturm et al., "A Benchmark for the Evaluation of RGB-D SLAM Systems", IROS 2012.
    """
    motion = fit_motion(estimate[:, :2], truth[:, :2])
    apart = transform(motion, estimate[:, :2]) - truth[:, :2]
    return float(np.sqrt(np.mean(np.sum(apart**2, axis=1))))
