from pathlib import Path

import numpy as np
import pytest

from simulator.slam.g2o import PoseGraphFileError, read_g2o, write_g2o
from simulator.slam.pose_graph import Edge, PoseGraph, Sighting
from tests.simulator.slam.graphs import square_graph


def test_what_was_written_reads_back_to_the_bit(tmp_path: Path) -> None:
    graph, _ = square_graph(seed=1)
    information = np.array([[3.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 9.0]])
    graph.edges.append(Edge(0, 9, np.array([0.1, 1 / 3, -2.0]), information, "inter"))
    graph.landmarks[100] = np.array([1 / 7, 2.0])
    matrix = np.array([[2.0, 0.5], [0.5, 1.0]])
    graph.sightings.append(Sighting(3, 100, np.array([1.0, 1.0]), matrix))
    write_g2o(graph, tmp_path / "square.g2o")
    again = read_g2o(tmp_path / "square.g2o")
    assert np.array_equal(again.trajectory(), graph.trajectory())
    assert np.array_equal(again.landmarks[100], graph.landmarks[100])
    for one, other in zip(graph.edges, again.edges, strict=True):
        assert (one.start, one.end, one.kind) == (other.start, other.end, other.kind)
        assert np.array_equal(one.measurement, other.measurement)
        assert np.array_equal(one.information, other.information)
    assert np.array_equal(again.sightings[0].information, matrix)


def test_landmarks_get_numbers_of_their_own(tmp_path: Path) -> None:
    graph = PoseGraph({0: np.zeros(3), 1: np.ones(3)}, [], {1: np.array([5.0, 5.0])})
    graph.sightings.append(Sighting(0, 1, np.array([5.0, 5.0]), np.eye(2)))
    write_g2o(graph, tmp_path / "one.g2o")
    again = read_g2o(tmp_path / "one.g2o")
    assert list(again.landmarks) == [3]
    assert again.sightings[0].landmark == 3


def read(tmp_path: Path, text: str) -> PoseGraph:
    path = tmp_path / "graph.txt"
    path.write_text(text)
    return read_g2o(path)


def test_older_formats_have_orders_of_their_own(tmp_path: Path) -> None:
    toro = read(tmp_path, "EDGE2 0 1 1 0 0 50 0 60 100 0 0\n").edges[0]
    assert np.array_equal(toro.information, np.diag([50.0, 60.0, 100.0]))
    isam = read(tmp_path, "EDGE2 0 1 1 0 0 3 0 0 4 0 5\n").edges[0]
    assert np.array_equal(isam.information, np.diag([9.0, 16.0, 25.0]))
    covariance = read(tmp_path, "ODOMETRY 0 1 1 0 0 0.01 0 0 0.04 0 0.25\n").edges[0]
    assert np.allclose(covariance.information, np.diag([100.0, 25.0, 4.0]))


def test_nodes_without_a_line_start_where_edges_put_them(tmp_path: Path) -> None:
    text = "EDGE_SE2 0 1 2 0 1.5707963267948966 1 0 0 1 0 1\nLANDMARK 1 4 1 0 0.4 0 0.4\n"
    graph = read(tmp_path, text + "EDGE_SE2 2 1 1 0 0 1 0 0 1 0 1\n")
    assert np.allclose(graph.poses[1], [2.0, 0.0, np.pi / 2])
    assert np.allclose(graph.poses[2], [2.0, -1.0, np.pi / 2])
    assert np.allclose(graph.landmarks[4], [2.0, 1.0])


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("EDGE_SE2 0 1 1 0 0 1 0 0", "3 columns are missing"),
        ("VERTEX_SE2 0 0 0 nan", "not finite"),
        ("VERTEX_SE2 zero 0 0 0", "invalid literal"),
        ("EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1", "not one of planar pose graphs"),
        ("ODOMETRY 0 1 1 0 0 0 0 0 0 0 0", "Singular"),
    ],
)
def test_a_malformed_line_is_named(tmp_path: Path, line: str, reason: str) -> None:
    with pytest.raises(PoseGraphFileError, match=f"graph.txt:2: .*{reason}"):
        read(tmp_path, f"# a comment\n{line}\n")
