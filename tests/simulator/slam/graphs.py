"""Pose graphs for tests: drives around a square, with noise, loops and wrong constraints."""

import numpy as np

from simulator.slam.pose import between, compose
from simulator.slam.pose_graph import Edge, EdgeKind, PoseGraph

NOISE = np.array([0.05, 0.05, 0.02])
INFORMATION = np.diag(1.0 / NOISE**2)


def square_truth(laps: int = 2, side: int = 6) -> np.ndarray:
    """(n, 3): a metre a step, a quarter turn at each corner."""
    poses = [np.zeros(3)]
    for step in range(1, 4 * side * laps):
        turn = np.pi / 2 if step % side == 0 else 0.0
        poses.append(compose(poses[-1], np.array([1.0, 0.0, turn])))
    return np.array(poses)


def noisy_edge(
    truth: np.ndarray, start: int, end: int, kind: EdgeKind, random: np.random.Generator
) -> Edge:
    measured = between(truth[start], truth[end]) + random.normal(0.0, NOISE)
    return Edge(start, end, measured, INFORMATION, kind)


def square_graph(seed: int, laps: int = 2, side: int = 6) -> tuple[PoseGraph, np.ndarray]:
    """A drive over the same square several times, dead-reckoned, and its truth."""
    random = np.random.default_rng(seed)
    truth = square_truth(laps, side)
    lap = 4 * side
    edges = [noisy_edge(truth, i, i + 1, "odometry", random) for i in range(len(truth) - 1)]
    edges += [noisy_edge(truth, i, i + lap, "loop", random) for i in range(0, len(truth) - lap, 2)]
    poses = {0: truth[0]}
    for edge in edges[: len(truth) - 1]:
        poses[edge.end] = compose(poses[edge.start], edge.measurement)
    return PoseGraph(poses, edges), truth
