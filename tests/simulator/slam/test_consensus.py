import numpy as np

from simulator.slam.back_end import joint_covariance
from simulator.slam.consensus import (
    InterEdge,
    largest_clique,
    pairwise_consistency,
    ransac_motions,
    relative_spread,
)
from simulator.slam.pose import Poses, between, compose
from simulator.slam.pose_graph import PoseGraph
from tests.simulator.slam.graphs import INFORMATION, NOISE, square_graph


def test_ransac_keeps_the_motions_that_agree() -> None:
    random = np.random.default_rng(0)
    truth = np.array([5.0, -3.0, 0.7])
    motions = np.concatenate(
        [
            compose(truth, random.normal(0.0, (0.1, 0.1, 0.01), (6, 3))),
            random.uniform(-20.0, 20.0, (10, 3)),
        ]
    )
    places = random.uniform(0.0, 3.0, (16, 2))
    assert ransac_motions(motions, places, random).tolist() == [0, 1, 2, 3, 4, 5]
    assert len(ransac_motions(np.zeros((0, 3)), np.zeros((0, 2)), random)) == 0


def test_the_largest_set_that_agrees_two_by_two() -> None:
    consistent = np.zeros((6, 6), dtype=bool)
    for a, b in ((0, 1), (1, 2), (0, 2), (3, 4), (2, 3)):
        consistent[a, b] = consistent[b, a] = True
    assert largest_clique(consistent).tolist() == [0, 1, 2]


def relative_covariance_by_sampling(graph: PoseGraph, a: int, b: int) -> np.ndarray:
    random = np.random.default_rng(1)
    chain = graph.edges[a:b]
    ends = np.zeros((4000, 3))
    for edge in chain:
        ends = compose(ends, compose(edge.measurement, random.normal(size=(4000, 3)) * NOISE))
    mean = between(graph.poses[a], graph.poses[b])
    away = between(mean, ends)
    turn = np.array([[np.cos(mean[2]), -np.sin(mean[2])], [np.sin(mean[2]), np.cos(mean[2])]])
    away[:, :2] = away[:, :2] @ turn.T
    return np.asarray(away.T @ away / len(away))


def test_spread_of_relative_poses_agrees_with_samples() -> None:
    graph, _ = square_graph(seed=3, laps=1)
    keys = [2, 9]
    poses = np.array([graph.poses[key] for key in keys])
    spread = relative_spread(joint_covariance(graph, keys), poses, (0.0, 0.0, 0.0))
    sampled = relative_covariance_by_sampling(graph, *keys)
    assert np.allclose(spread[0, 1], sampled, atol=0.15 * np.abs(sampled).max())


def crossing(truth: Poses, a: int, b: int, random: np.random.Generator, spoil: float) -> InterEdge:
    measured = compose(between(truth[a], truth[b]), random.normal(0.0, NOISE))
    measured = compose(measured, np.array([spoil, 0.0, 0.0]))
    return InterEdge("a", a, "b", b, measured, INFORMATION)


def test_constraints_that_close_loops_are_consistent_and_others_are_not() -> None:
    graph, truth = square_graph(seed=4, laps=1)
    random = np.random.default_rng(4)
    places = [(0, 3), (5, 7), (12, 10), (18, 19), (9, 9)]
    spoilt = [0.0, 0.0, 0.0, 4.0, 0.0]
    edges = [crossing(truth, a, b, random, s) for (a, b), s in zip(places, spoilt, strict=True)]
    keys_a, keys_b = [a for a, _ in places], [b for _, b in places]
    poses_a = np.array([graph.poses[key] for key in keys_a])
    poses_b = np.array([graph.poses[key] for key in keys_b])
    consistent = pairwise_consistency(
        edges,
        poses_a,
        poses_b,
        relative_spread(joint_covariance(graph, keys_a), poses_a),
        relative_spread(joint_covariance(graph, keys_b), poses_b),
    )
    assert largest_clique(consistent).tolist() == [0, 1, 2, 4]
