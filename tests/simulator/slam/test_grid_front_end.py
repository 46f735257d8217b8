from dataclasses import replace

import numpy as np
import pytest

from simulator.slam.grid_front_end import (
    GridFrontEndParameters,
    align_grid_maps,
    learned_threshold,
    merge_grid_maps,
    reference_map,
)
from simulator.slam.pose import between, compose, inverse
from tests.simulator.slam.rooms import node_truth, office_drive, office_map


def frame_in_world(floor: int, seed: int) -> np.ndarray:
    robot_map = office_map(floor, seed)
    truth = node_truth(robot_map, office_drive(floor, seed))
    return compose(truth[0], inverse(robot_map.graph.poses[0]))


@pytest.mark.parametrize("method", ["pcm", "ransac"])
def test_two_floors_of_a_building_are_aligned(method: str) -> None:
    parameters = replace(GridFrontEndParameters(sequence=25, stride=5), method=method)  # type: ignore[arg-type]
    a, b = office_map(0, 1), office_map(1, 3)
    shifted = b.with_graph(b.graph.moved(np.array([7.0, -20.0, 1.9])))
    found = align_grid_maps(
        reference_map(a, parameters), shifted, np.random.default_rng(5), parameters
    )
    assert found.alignment is not None
    truth = between(frame_in_world(0, 1), compose(frame_in_world(1, 3), np.zeros(3)))
    motion = compose(found.alignment.motion, np.array([7.0, -20.0, 1.9]))
    away = between(truth, motion)
    assert np.hypot(away[0], away[1]) < 0.3
    assert abs(away[2]) < 0.03


def test_the_threshold_is_learned_from_the_robots_own_scans() -> None:
    parameters = GridFrontEndParameters()
    assert 0.3 < learned_threshold(office_map(0, 1), parameters) < parameters.threshold_share


def test_merging_makes_one_graph_in_one_frame() -> None:
    a, b = office_map(0, 1), office_map(1, 3)
    moved = b.with_graph(b.graph.moved(np.array([3.0, 4.0, -1.0])))
    merged, tried = merge_grid_maps(
        [a, moved], np.random.default_rng(5), GridFrontEndParameters(sequence=25, stride=5)
    )
    assert merged.alone == ()
    assert len(tried) == 1
    truth = [node_truth(office_map(*key), office_drive(*key)) for key in ((0, 1), (1, 3))]
    estimate = [merged.robot_maps[m.robot].graph.trajectory() for m in (a, b)]
    # The relative pose of the two robots' first nodes.
    away = between(between(truth[0][0], truth[1][0]), between(estimate[0][0], estimate[1][0]))
    assert np.hypot(away[0], away[1]) < 0.3
    assert abs(away[2]) < 0.05
