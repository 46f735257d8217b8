from dataclasses import replace

import numpy as np
import pytest

from simulator.slam.consensus import InterEdge
from simulator.slam.merging import Alignment, merge
from simulator.slam.pose import between, compose, inverse, transform
from simulator.slam.pose_graph import Sighting, absolute_trajectory_error_m
from simulator.slam.robot_map import RobotMap
from tests.simulator.slam.graphs import INFORMATION, square_graph

FRAMES = {"a": np.zeros(3), "b": np.array([20.0, 5.0, 1.0]), "c": np.array([-4.0, 9.0, -2.0])}


def team() -> tuple[list[RobotMap], np.ndarray]:
    """Three robots on the same square, each in a frame of its own."""
    maps = []
    for seed, (name, frame) in enumerate(FRAMES.items()):
        graph, truth = square_graph(seed, laps=1)
        maps.append(RobotMap(name, graph.moved(inverse(frame))))
    return maps, truth


def constraints(a: str, b: str, truth: np.ndarray, nodes: list[tuple[int, int]]) -> Alignment:
    edges = tuple(InterEdge(a, i, b, j, between(truth[i], truth[j]), INFORMATION) for i, j in nodes)
    return Alignment(a, b, between(FRAMES[a], FRAMES[b]), edges)


def test_robots_are_merged_along_chains_of_alignments() -> None:
    maps, truth = team()
    merged = merge(
        maps,
        [
            constraints("c", "b", truth, [(0, 1), (6, 5), (12, 12)]),
            constraints("a", "b", truth, [(0, 0), (7, 8), (13, 13), (20, 19)]),
        ],
    )
    assert merged.alone == ()
    assert np.all(merged.weights > 0.5)
    for name, robot_map in merged.robot_maps.items():
        own = next(m for m in maps if m.robot == name).graph.trajectory()
        before = np.hypot(*(compose(FRAMES[name], own) - truth)[:, :2].T).mean()
        joint = np.hypot(*(robot_map.graph.trajectory() - truth)[:, :2].T).mean()
        assert joint < before + 0.05
        assert absolute_trajectory_error_m(robot_map.graph.trajectory(), truth) < 1.0


def test_a_robot_without_an_alignment_stays_alone() -> None:
    maps, truth = team()
    merged = merge(maps, [constraints("a", "b", truth, [(0, 0), (7, 8), (13, 13)])])
    assert merged.alone == ("c",)
    assert sorted(merged.robot_maps) == ["a", "b"]


def test_a_wrong_constraint_that_slipped_through_is_dropped() -> None:
    maps, truth = team()
    right = constraints("a", "b", truth, [(0, 0), (7, 8), (13, 13), (20, 19)])
    wrong = InterEdge("a", 3, "b", 15, np.array([0.5, 0.2, 0.1]), INFORMATION)
    merged = merge(maps[:2], [replace(right, edges=(*right.edges, wrong))])
    assert merged.weights[-1] < 0.1
    assert np.all(merged.weights[:-1] > 0.9)


def test_shared_landmarks_tie_graphs_together() -> None:
    maps, truth = team()
    trees = np.array([[3.0, 3.0], [-2.0, 4.0], [8.0, 1.0]])
    seen = []
    for robot_map in maps[:2]:
        graph = robot_map.graph
        sightings = [
            Sighting(node, key, between(truth[node], np.array([*tree, 0.0]))[:2], 400.0 * np.eye(2))
            for node in range(0, 24, 3)
            for key, tree in enumerate(trees)
        ]
        landmarks = {
            key: transform(inverse(FRAMES[robot_map.robot]), tree[None])[0]
            for key, tree in enumerate(trees)
        }
        seen.append(robot_map.with_graph(replace(graph, landmarks=landmarks, sightings=sightings)))
    alignment = Alignment("a", "b", between(FRAMES["a"], FRAMES["b"]), (), ((0, 0), (1, 1), (2, 2)))
    merged = merge(seen, [alignment])
    assert merged.landmarks["a"] == merged.landmarks["b"]
    for key in range(3):
        positions = [merged.robot_maps[name].graph.landmarks[key] for name in ("a", "b")]
        assert np.array_equal(*positions)


def test_names_have_to_be_different() -> None:
    maps, _ = team()
    with pytest.raises(ValueError, match="name of its own"):
        merge([maps[0], maps[0]], [])
