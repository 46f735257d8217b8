"""Joint pose graphs of several robots: frames from constraints between them, then one optimum.

Thesis 4.2.2 and the last lines of Algorithms 3 and 4. Constraints have passed a consensus before;
here they still count as doubtful, and graduated non-convexity with odometry as inliers may drop
them once the frames roughly agree.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from simulator.slam.back_end import BackEndParameters, optimise_with_outliers
from simulator.slam.consensus import InterEdge
from simulator.slam.pose import Poses, compose, inverse
from simulator.slam.pose_graph import Edge, PoseGraph
from simulator.slam.robot_map import RobotMap


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """Two robots' maps brought together."""

    robot_a: str
    robot_b: str
    motion: Poses
    """(3,): brings the second robot's frame onto the first's"""
    edges: tuple[InterEdge, ...] = ()
    landmarks: tuple[tuple[int, int], ...] = ()
    """keys of landmarks of the first and the second graph that are the same"""

    @property
    def weight(self) -> int:
        """How much speaks for it."""
        return len(self.edges) + len(self.landmarks)


@dataclass(frozen=True, slots=True)
class MergedMap:
    """Robots that hang together, each with poses in the frame of the first of them."""

    robot_maps: dict[str, RobotMap]
    """keys of nodes as each robot has them"""
    frames: dict[str, Poses]
    """robot -> pose of its own frame before the joint optimisation"""
    edges: tuple[InterEdge, ...]
    """constraints between the robots"""
    weights: NDArray[np.float64]
    """(edges,): 0 where the optimisation dropped one"""
    landmarks: dict[str, dict[int, int]] = field(default_factory=dict)
    """robot -> its landmark -> the joint landmark"""
    alone: tuple[str, ...] = ()
    """robots that no alignment connects with the first"""


def merge(
    robot_maps: Sequence[RobotMap],
    alignments: Sequence[Alignment],
    parameters: BackEndParameters | None = None,
) -> MergedMap:
    """One joint optimum of all robots that alignments connect with the first.

    Raises:
        ValueError: no robot, or two with the same name.
    """
    by_name = {robot_map.robot: robot_map for robot_map in robot_maps}
    if not by_name or len(by_name) != len(robot_maps):
        raise ValueError("merging needs at least one robot, each with a name of its own")
    first = robot_maps[0].robot
    frames, used = _frames(first, alignments)
    members = [name for name in by_name if name in frames]
    joint, offsets, shared = _side_by_side([by_name[name] for name in members], frames, used)
    inter = [edge for alignment in used for edge in alignment.edges]
    begin = len(joint.edges)
    for edge in inter:
        start = edge.node_a + offsets[edge.robot_a]
        end = edge.node_b + offsets[edge.robot_b]
        joint.edges.append(Edge(start, end, edge.measurement, edge.information, "inter"))
    found = optimise_with_outliers(joint, parameters or BackEndParameters(kernel="huber"))
    merged = {
        name: by_name[name].with_graph(
            _part(by_name[name].graph, found.graph, offsets[name], shared[name])
        )
        for name in members
    }
    alone = tuple(name for name in by_name if name not in frames)
    return MergedMap(merged, frames, tuple(inter), found.weights[begin:], shared, alone)


def _frames(
    first: str, alignments: Sequence[Alignment]
) -> tuple[dict[str, Poses], list[Alignment]]:
    """Frames along the tree of the weightiest alignments; all that connect its members."""
    frames: dict[str, Poses] = {first: np.zeros(3)}
    ordered = sorted(alignments, key=lambda a: (-a.weight, a.robot_a, a.robot_b))
    while True:
        for alignment in ordered:
            a, b = alignment.robot_a, alignment.robot_b
            if (a in frames) != (b in frames):
                if a in frames:
                    frames[b] = compose(frames[a], alignment.motion)
                else:
                    frames[a] = compose(frames[b], inverse(alignment.motion))
                break
        else:
            break
    used = [a for a in ordered if a.robot_a in frames and a.robot_b in frames]
    return frames, used


def _side_by_side(
    robot_maps: Sequence[RobotMap], frames: Mapping[str, Poses], used: Sequence[Alignment]
) -> tuple[PoseGraph, dict[str, int], dict[str, dict[int, int]]]:
    """All graphs in one, offsets of their nodes' keys, and the joint landmarks."""
    joint = PoseGraph()
    offsets: dict[str, int] = {}
    shared = _joint_landmarks(robot_maps, used)
    next_key = 0
    for robot_map in robot_maps:
        name, graph = robot_map.robot, robot_map.graph.moved(frames[robot_map.robot])
        offsets[name] = next_key - min(graph.poses, default=0)
        moved = graph.renumbered(offsets[name], 0)
        joint.poses.update(moved.poses)
        joint.edges.extend(moved.edges)
        for key, at in graph.landmarks.items():
            joint.landmarks.setdefault(shared[name][key], at)
        joint.sightings.extend(
            replace(s, landmark=shared[name][s.landmark]) for s in moved.sightings
        )
        next_key = max(joint.poses) + 1
    return joint, offsets, shared


def _joint_landmarks(
    robot_maps: Sequence[RobotMap], used: Sequence[Alignment]
) -> dict[str, dict[int, int]]:
    """A number for every landmark, the same for those that alignments identify (union-find)."""
    nodes = [(m.robot, key) for m in robot_maps for key in sorted(m.graph.landmarks)]
    parent = {node: node for node in nodes}

    def root(node: tuple[str, int]) -> tuple[str, int]:
        while parent[node] != node:
            parent[node] = parent[parent[node]]
            node = parent[node]
        return node

    for alignment in used:
        for a, b in alignment.landmarks:
            one, other = root((alignment.robot_a, a)), root((alignment.robot_b, b))
            if one != other:
                parent[max(one, other)] = min(one, other)
    numbers: dict[tuple[str, int], int] = {}
    joint: dict[str, dict[int, int]] = {robot_map.robot: {} for robot_map in robot_maps}
    for robot, key in nodes:
        representative = root((robot, key))
        number = numbers.setdefault(representative, len(numbers))
        joint[robot][key] = number
    return joint


def _part(own: PoseGraph, joint: PoseGraph, offset: int, shared: Mapping[int, int]) -> PoseGraph:
    """A robot's own graph with poses and landmarks of the joint optimum."""
    return replace(
        own,
        poses={key: joint.poses[key + offset] for key in own.poses},
        landmarks={key: joint.landmarks[shared[key]] for key in own.landmarks},
    )
