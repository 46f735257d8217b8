from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares

from simulator.slam.back_end import (
    BackEndParameters,
    IncrementalBackEnd,
    joint_covariance,
    optimise,
    optimise_with_outliers,
)
from simulator.slam.g2o import read_g2o
from simulator.slam.pose import between, compose
from simulator.slam.pose_graph import (
    Edge,
    PoseGraph,
    Sighting,
    absolute_trajectory_error_m,
    chi2,
)
from tests.simulator.slam.graphs import INFORMATION, NOISE, square_graph

DATA = Path(__file__).parents[4] / "shared" / "data" / "posegraphs"


def test_the_optimum_is_the_one_that_another_solver_finds() -> None:
    graph, _ = square_graph(seed=1, laps=2, side=3)
    keys = sorted(graph.poses)

    def residuals(flat: np.ndarray) -> np.ndarray:
        poses = {0: graph.poses[0]} | dict(zip(keys[1:], flat.reshape(-1, 3), strict=True))
        errors = [
            between(edge.measurement, between(poses[edge.start], poses[edge.end])) / NOISE
            for edge in graph.edges
        ]
        return np.concatenate(errors)

    guess = np.array([graph.poses[key] for key in keys[1:]]).ravel()
    oracle = 2.0 * least_squares(residuals, guess, xtol=1e-12, ftol=1e-12).cost
    found = optimise(graph)
    assert found.chi2_before > 2.0 * found.chi2_after
    assert found.chi2_after == pytest.approx(oracle, rel=1e-3)


def test_loops_take_the_drift_out() -> None:
    graph, truth = square_graph(seed=2)
    before = absolute_trajectory_error_m(graph.trajectory(), truth)
    after = absolute_trajectory_error_m(optimise(graph).graph.trajectory(), truth)
    assert after < 0.5 * before


def with_wrong_loops(graph: PoseGraph, count: int, random: np.random.Generator) -> PoseGraph:
    wrong = []
    for _ in range(count):
        start, end = random.choice(len(graph.poses), 2, replace=False)
        measured = np.array([*random.uniform(-3.0, 3.0, 2), random.uniform(-3.0, 3.0)])
        wrong.append(Edge(int(start), int(end), measured, INFORMATION, "inter"))
    return replace(graph, edges=graph.edges + wrong)


def test_graduated_non_convexity_finds_the_wrong_constraints() -> None:
    graph, truth = square_graph(seed=3)
    spoilt = with_wrong_loops(optimise(graph).graph, 8, np.random.default_rng(3))
    naive = absolute_trajectory_error_m(optimise(spoilt).graph.trajectory(), truth)
    robust = optimise_with_outliers(spoilt)
    assert np.all(robust.weights[-8:] < 0.01)
    assert np.all(robust.weights[:-8] > 0.99)
    assert absolute_trajectory_error_m(robust.graph.trajectory(), truth) < 0.3 * naive


@pytest.mark.parametrize("kernel", ["huber", "cauchy", "geman-mcclure", "dcs", "tukey"])
def test_a_kernel_limits_the_harm_of_wrong_constraints(kernel: str) -> None:
    graph, truth = square_graph(seed=4)
    spoilt = with_wrong_loops(optimise(graph).graph, 4, np.random.default_rng(4))
    naive = absolute_trajectory_error_m(optimise(spoilt).graph.trajectory(), truth)
    parameters = BackEndParameters(kernel=kernel)  # type: ignore[arg-type]
    robust = optimise(spoilt, parameters).graph.trajectory()
    assert absolute_trajectory_error_m(robust, truth) < 0.6 * naive


def test_incremental_estimates_end_at_the_batch_optimum() -> None:
    graph, _ = square_graph(seed=5)
    back_end = IncrementalBackEnd()
    poses: dict[int, np.ndarray] = {}
    by_end: dict[int, list[Edge]] = {}
    for edge in graph.edges:
        by_end.setdefault(max(edge.start, edge.end), []).append(edge)
    for key in sorted(graph.poses):
        edges = by_end.get(key, [])
        guess = compose(poses[edges[0].start], edges[0].measurement) if edges else np.zeros(3)
        back_end.add_pose(key, guess)
        for edge in edges:
            back_end.add_edge(edge)
        poses = back_end.update()
    poses = back_end.update(relinearisations=5)
    best = optimise(graph).chi2_after
    assert chi2(replace(graph, poses=poses)) == pytest.approx(best, rel=1e-2)


def test_landmarks_are_estimated_with_the_poses() -> None:
    random = np.random.default_rng(6)
    graph, truth = square_graph(seed=6, laps=1)
    trees = {5: np.array([3.0, 3.0]), 6: np.array([-2.0, 4.0]), 7: np.array([8.0, 1.0])}
    sightings = [
        Sighting(
            pose,
            tree,
            between(truth[pose], np.array([*at, 0.0]))[:2] + random.normal(0.0, 0.03, 2),
            np.eye(2) / 0.03**2,
        )
        for pose in graph.poses
        for tree, at in trees.items()
    ]
    seen = replace(graph, landmarks={k: v + 0.5 for k, v in trees.items()}, sightings=sightings)
    found = optimise(seen).graph
    assert absolute_trajectory_error_m(found.trajectory(), truth) < 0.05
    assert all(np.linalg.norm(found.landmarks[k] - trees[k]) < 0.1 for k in trees)


def test_covariance_of_a_chain_is_the_sum_of_its_steps() -> None:
    straight = {i: np.array([float(i), 0.0, 0.0]) for i in range(4)}
    step = np.array([1.0, 0.0, 0.0])
    edges = [Edge(i, i + 1, step, np.diag([100.0, 100.0, 1e8])) for i in range(3)]
    joint = joint_covariance(PoseGraph(straight, edges), [3, 1])
    assert joint.shape == (6, 6)
    assert joint[0, 0] == pytest.approx(0.03, rel=1e-3)
    assert joint[3, 3] == pytest.approx(0.01, rel=1e-3)
    assert joint[0, 3] == pytest.approx(0.01, rel=1e-3)


def test_a_graph_in_two_parts_is_refused() -> None:
    apart = PoseGraph({0: np.zeros(3), 1: np.ones(3), 2: np.ones(3)})
    apart.edges.append(Edge(0, 1, np.ones(3), np.eye(3)))
    with pytest.raises(ValueError, match="2 parts"):
        optimise(apart)


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is not here")
@pytest.mark.parametrize(
    ("name", "reference"),
    [("intel.g2o", 546.46), ("manhattanOlson3500.g2o", 146.08), ("csail.g2o", 39.0)],
)
def test_public_pose_graphs_reach_the_reference_chi2(name: str, reference: float) -> None:
    found = optimise(read_g2o(DATA / name))
    assert found.chi2_after < 1.01 * reference
    assert found.chi2_after == pytest.approx(chi2(found.graph))


@pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is not here")
def test_manhattan_is_close_to_its_ground_truth() -> None:
    truth = read_g2o(DATA / "manhattanOlson3500_groundtruth.txt").trajectory()
    estimate = optimise(read_g2o(DATA / "manhattanOlson3500.g2o")).graph.trajectory()
    assert absolute_trajectory_error_m(estimate, truth) < 0.8
