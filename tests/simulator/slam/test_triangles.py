import numpy as np
import pytest

from simulator.slam.pose import inverse, transform
from simulator.slam.triangles import (
    TriangleParameters,
    correspondences,
    dissimilarity,
    motions,
    triangulate,
)


def test_features_of_a_triangle_by_hand() -> None:
    right_angled = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]])
    triangles = triangulate(right_angled)
    assert triangles.edges_m.tolist() == [[3.0, 4.0, 5.0]]
    # Eq. 4.14: perimeter 12; eq. 4.15: area 6.
    assert triangles.features[0] == pytest.approx([12.0, np.sqrt(6.0)])
    # The shortest edge, 3, lies between (0, 0) and (0, 3): opposite (4, 0).
    assert right_angled[triangles.corners[0]].tolist() == [[4, 0], [0, 3], [0, 0]]


def test_congruent_triangles_have_dissimilarity_one_and_it_grows() -> None:
    feature = np.array([12.0, 2.5])
    apart = [dissimilarity(feature, feature + d, 0.5) for d in (0.0, 0.1, 0.5)]
    assert apart[0] == 1.0
    assert apart[0] < apart[1] < apart[2]


def test_tree_search_finds_what_comparing_all_pairs_finds() -> None:
    random = np.random.default_rng(1)
    first = random.uniform(0.0, 100.0, (40, 2))
    second = first + random.normal(0.0, 0.05, (40, 2))
    parameters = TriangleParameters(candidates=10_000, neighbours=0)
    a, b = triangulate(first, parameters), triangulate(second, parameters)
    s = dissimilarity(a.features[:, None], b.features[None], parameters.scale_m)
    similar = {
        (int(i), int(j))
        for i, j in np.argwhere(s < parameters.tau)
        if np.all(np.abs(a.edges_m[i] - b.edges_m[j]) < parameters.edge_tolerance_m)
        and a.left_handed[i] == b.left_handed[j]
    }
    assert {(i, j) for i, j in correspondences(a, b, parameters).tolist()} == similar
    assert len(similar) >= 40


def test_a_mirrored_map_has_no_correspondence() -> None:
    scalene = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]])
    mirrored = scalene * np.array([-1.0, 1.0])
    assert len(correspondences(triangulate(scalene), triangulate(mirrored))) == 0
    assert len(correspondences(triangulate(scalene), triangulate(scalene))) == 1


def test_one_correspondence_gives_the_motion() -> None:
    truth = np.array([5.0, -2.0, 2.2])
    to = np.array([[0.0, 0.0], [4.0, 0.0], [0.5, 3.0]])
    moved = transform(inverse(truth), to)
    a, b = triangulate(to), triangulate(moved)
    found = motions(a, b, correspondences(a, b), moved, to)
    assert np.allclose(found, truth[None])


def test_too_few_landmarks_or_a_row_of_them_have_no_triangles() -> None:
    row = np.stack([np.arange(5.0), np.zeros(5)], axis=1)
    for positions in (np.zeros((0, 2)), np.ones((2, 2)), row):
        triangles = triangulate(positions, TriangleParameters(neighbours=0))
        assert len(triangles.corners) == 0
        assert len(correspondences(triangles, triangles)) == 0
