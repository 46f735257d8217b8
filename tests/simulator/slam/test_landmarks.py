import numpy as np

from simulator.slam.landmarks import LandmarkMapper, LandmarkParameters
from simulator.slam.pose import between


def seen_from(pose: np.ndarray, trees: np.ndarray) -> np.ndarray:
    return np.array([between(pose, np.array([*tree, 0.0]))[:2] for tree in trees])


def test_detections_of_the_same_tree_make_one_landmark_and_sharpen_it() -> None:
    random = np.random.default_rng(0)
    trees = np.array([[5.0, 5.0], [9.0, 1.0], [-4.0, 3.0]])
    mapper = LandmarkMapper(LandmarkParameters(range_deviation_m=0.1))
    for step in range(30):
        pose = np.array([0.1 * step, 0.05 * step, 0.02 * step])
        seen = seen_from(pose, trees) + random.normal(0.0, 0.07, (3, 2))
        assert mapper.add(pose, seen).tolist() == [0, 1, 2]
    found = mapper.landmark_map()
    assert np.all(np.linalg.norm(found.positions_m - trees, axis=1) < 0.06)
    assert np.all(found.deviations_m < 0.05)


def test_what_was_seen_once_is_taken_for_a_mistake() -> None:
    mapper = LandmarkMapper(LandmarkParameters(least_sightings=2))
    mapper.add(np.zeros(3), np.array([[3.0, 0.0], [8.0, 1.0]]))
    mapper.add(np.zeros(3), np.array([[3.05, 0.0]]))
    assert len(mapper.landmark_map().positions_m) == 1


def test_two_detections_are_never_the_same_landmark() -> None:
    mapper = LandmarkMapper()
    mapper.add(np.zeros(3), np.array([[3.0, 0.0]]))
    numbers = mapper.add(np.zeros(3), np.array([[3.0, 0.1], [3.0, 0.4]]))
    assert numbers.tolist() == [0, 1]


def test_no_detections_no_landmarks() -> None:
    mapper = LandmarkMapper()
    assert len(mapper.add(np.zeros(3), np.zeros((0, 2)))) == 0
    assert len(mapper.landmark_map().positions_m) == 0
