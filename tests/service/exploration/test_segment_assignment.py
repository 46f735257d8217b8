"""Algorithm 2: robots to segments, then to targets inside them."""

import numpy as np
import pytest
from numpy.typing import NDArray

from semantic_attachments.world import GridMap
from service.coordination.assignment import hungarian
from service.coordination.exploration.cost_based import HungarianCosts
from service.coordination.exploration.problem import ExplorationProblem
from service.coordination.exploration.segment_assignment import assign_by_segment

INF = np.inf


def labels(*values: int) -> NDArray[np.int32]:
    return np.array(values, dtype=np.int32)


def test_robots_go_to_different_segments_where_costs_alone_send_both_into_one() -> None:
    costs = np.array([[1.0, 2.0, 9.0], [2.0, 1.0, 9.5]])
    assert hungarian(costs.tolist()) == {0: 0, 1: 1}
    by_segment = assign_by_segment(costs, labels(1, 1, 2), labels(0, 0), discount=1.0)
    assert by_segment == {0: 2, 1: 1}


def test_a_robot_stays_in_its_segment() -> None:
    costs = np.array([[6.0, 5.0], [5.0, 4.5]])
    without = assign_by_segment(costs, labels(1, 2), labels(1, 2), discount=1.0)
    assert sum(costs[row, column] for row, column in without.items()) == 10.0
    moved = np.array([[6.0, 5.0], [5.0, 4.5]]) - np.array([[0.0, 1.0], [0.0, 0.0]])
    assert assign_by_segment(moved, labels(1, 2), labels(1, 2), discount=1.0) == {0: 1, 1: 0}
    assert assign_by_segment(moved, labels(1, 2), labels(1, 2), discount=0.5) == {0: 0, 1: 1}


def test_with_one_segment_it_is_the_cost_based_method() -> None:
    random = np.random.default_rng(7)
    for _ in range(50):
        robots, targets = random.integers(1, 9, 2)
        costs = random.uniform(1.0, 50.0, (robots, targets))
        costs[random.random(costs.shape) < 0.2] = INF
        found = assign_by_segment(
            costs, np.full(targets, 3, np.int32), np.full(robots, 3, np.int32), discount=0.5
        )
        problem = ExplorationProblem(
            grid=GridMap(np.zeros((1, 1), np.int8), 1.0),
            robot_cells=np.zeros(robots, np.int64),
            target_cells=np.zeros(targets, np.int64),
            costs_s=costs,
            sensor_range_m=5.0,
            speed_m_s=1.0,
        )
        assert found == HungarianCosts().assign(problem)


def test_no_segment_gets_a_second_robot_before_each_has_one() -> None:
    random = np.random.default_rng(8)
    for _ in range(50):
        robots = int(random.integers(2, 12))
        targets = int(random.integers(robots, 30))
        segment_of = random.integers(1, 6, targets).astype(np.int32)
        costs = random.uniform(1.0, 50.0, (robots, targets))
        found = assign_by_segment(costs, segment_of, np.zeros(robots, np.int32), discount=0.5)
        assert len(found) == robots
        numbers = {n: sum(segment_of[t] == n for t in found.values()) for n in set(segment_of)}
        assert min(numbers.values()) > 0 or max(numbers.values()) == 1


def test_who_can_only_go_where_others_go_joins_them() -> None:
    costs = np.array([[1.0, INF], [2.0, INF]])
    assert assign_by_segment(costs, labels(1, 2), labels(0, 0), discount=1.0) == {0: 0, 1: 0}


def test_a_large_team_is_distributed_by_the_work() -> None:
    costs = np.ones((12, 3))
    work = np.array([0, 10, 20, 30])
    found = assign_by_segment(costs, labels(1, 2, 3), np.zeros(12, np.int32), 0.5, work)
    counts = [sum(target == k for target in found.values()) for k in range(3)]
    assert counts == [2, 4, 6]
    evenly = assign_by_segment(costs, labels(1, 2, 3), np.zeros(12, np.int32), 0.5)
    assert [sum(target == k for target in evenly.values()) for k in range(3)] == [4, 4, 4]


def test_nobody_is_sent_where_it_cannot_go() -> None:
    """Equation 2.4: the first robot cannot enter the second segment."""
    costs = np.array([[9.0, INF], [1.0, 8.0], [INF, INF]])
    found = assign_by_segment(costs, labels(1, 2), labels(0, 0, 0), discount=0.5)
    assert found == {0: 0, 1: 1}


@pytest.mark.parametrize("shape", [(0, 3), (3, 0), (0, 0)])
def test_without_robots_or_targets_nothing_is_assigned(shape: tuple[int, int]) -> None:
    robots, targets = shape
    found = assign_by_segment(
        np.zeros(shape), np.ones(targets, np.int32), np.ones(robots, np.int32), 0.5
    )
    assert found == {}
