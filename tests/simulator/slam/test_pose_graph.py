import numpy as np
import pytest

from simulator.slam.pose import between, compose
from simulator.slam.pose_graph import (
    Edge,
    PoseGraph,
    Sighting,
    absolute_trajectory_error_m,
    chi2,
    dead_reckoning,
    edge_errors,
)

A, B = np.array([1.0, 2.0, 0.5]), np.array([3.0, -1.0, 2.0])


def test_error_of_an_edge_by_hand() -> None:
    # B lies 2 m ahead of A; 1.9 m was measured, and 0.1 rad too much.
    poses = {0: np.zeros(3), 1: np.array([2.0, 0.0, 0.0])}
    edge = Edge(0, 1, np.array([1.9, 0.0, 0.1]), np.diag([100.0, 100.0, 400.0]))
    turned = 0.1 * np.array([np.cos(0.1), -np.sin(0.1)])
    expected = 100.0 * np.sum(turned**2) + 400.0 * 0.01
    assert edge_errors(PoseGraph(poses, [edge]))[0] == pytest.approx(expected)


def test_perfect_measurements_have_no_error_in_any_frame() -> None:
    graph = PoseGraph(
        {0: A, 1: B},
        [Edge(0, 1, between(A, B), np.eye(3))],
        {7: np.array([4.0, 4.0])},
        [Sighting(0, 7, between(A, np.array([4.0, 4.0, 0.0]))[:2], np.diag([4.0, 9.0]))],
    )
    assert chi2(graph) == pytest.approx(0.0, abs=1e-18)
    assert chi2(graph.moved(np.array([-3.0, 8.0, 1.2]))) == pytest.approx(0.0, abs=1e-18)
    assert chi2(graph.renumbered(100, 50)) == pytest.approx(0.0, abs=1e-18)


def test_dead_reckoning_follows_the_odometry() -> None:
    graph = PoseGraph({0: A, 1: np.zeros(3)}, [Edge(0, 1, B, np.eye(3))])
    assert np.allclose(dead_reckoning(graph).poses[1], compose(A, B))


def test_trajectory_error_does_not_depend_on_the_frame() -> None:
    track = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 3.0, 0.0], [2.0, 5.0, 0.0]])
    assert absolute_trajectory_error_m(compose(A, track), track) == pytest.approx(0.0, abs=1e-9)
    bent = track + np.array([[0.0, 0.4, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert 0.05 < absolute_trajectory_error_m(bent, track) < 0.2


@pytest.mark.parametrize(
    ("edge", "reason"),
    [
        (Edge(0, 9, B, np.eye(3)), "unknown pose 9"),
        (Edge(0, 1, B, np.diag([1.0, 0.0, 1.0])), "positive diagonal"),
        (Edge(0, 1, B, np.triu(np.ones((3, 3)))), "symmetric"),
    ],
)
def test_a_malformed_constraint_is_named(edge: Edge, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        PoseGraph({0: A, 1: B}, [edge]).check()
