import numpy as np
import pytest
from scipy.spatial import KDTree

from simulator.slam.landmark_alignment import (
    AlignmentParameters,
    align_landmarks,
    chance_of_alignment,
    matched_landmarks,
)
from simulator.slam.pose import Poses, between, inverse, transform


def two_maps(shared: int, seed: int, count: int = 100) -> tuple[np.ndarray, np.ndarray, Poses]:
    """Landmark maps of neighbouring parts of a park, the second in a frame of its own."""
    random = np.random.default_rng(seed)
    park = random.uniform(0.0, 300.0, (2 * count - shared, 2))
    park = park[np.argsort(park[:, 0])]
    truth = np.array([*random.uniform(-100.0, 100.0, 2), random.uniform(-3.0, 3.0)])
    noise = random.normal(0.0, 0.05, (2, count, 2))
    first = park[:count] + noise[0]
    second = transform(inverse(truth), park[count - shared :] + noise[1])
    return random.permutation(first), random.permutation(second), truth


@pytest.mark.parametrize("method", ["ransac", "pcm"])
@pytest.mark.parametrize("shared", [100, 40, 20, 12])
def test_overlapping_maps_are_aligned(method: str, shared: int) -> None:
    for seed in range(3):
        first, second, truth = two_maps(shared, seed)
        parameters = AlignmentParameters(method=method)  # type: ignore[arg-type]
        found = align_landmarks(first, second, np.random.default_rng(0), parameters)
        assert found is not None
        assert found.accepted
        assert shared - 2 <= len(found.matches) <= shared + 3
        middle = second[found.matches[:, 1]].mean(axis=0)[None]
        apart = np.linalg.norm(transform(truth, middle) - transform(found.motion, middle))
        assert apart < 0.1
        assert abs(between(truth, found.motion)[2]) < 0.01


@pytest.mark.parametrize("method", ["ransac", "pcm"])
def test_maps_of_different_places_are_not_aligned(method: str) -> None:
    parameters = AlignmentParameters(method=method)  # type: ignore[arg-type]
    for seed in range(10):
        first, second, _ = two_maps(0, seed)
        found = align_landmarks(first, second, np.random.default_rng(0), parameters)
        assert found is None or not found.accepted


def test_the_same_seed_finds_the_same() -> None:
    first, second, _ = two_maps(30, 1)
    once, again = (align_landmarks(first, second, np.random.default_rng(3)) for _ in range(2))
    assert once is not None
    assert again is not None
    assert np.array_equal(once.motion, again.motion)


def test_chance_is_as_rare_as_it_is_in_random_maps() -> None:
    random = np.random.default_rng(0)
    first = random.uniform(0.0, 50.0, (60, 2))
    inside, trials = 0, 3000
    tree = KDTree(first)
    second = random.uniform(10.0, 40.0, (20, 2))
    for _ in range(trials):
        motion = np.array([*random.uniform(-8.0, 8.0, 2), 0.0])
        inside += len(matched_landmarks(second, tree, motion, 0.8)) >= 3
    # One motion, two matches of which fix it: at least one more.
    expected = chance_of_alignment(first, second, np.zeros(3), count=5, match_m=0.8, tried=1)
    assert 0.3 < (inside / trials) / expected < 3.0


def test_maps_of_two_landmarks_cannot_be_aligned() -> None:
    assert align_landmarks(np.zeros((2, 2)), np.zeros((2, 2)), np.random.default_rng(0)) is None
