"""Greedy choice by utility less cost."""

import numpy as np

from semantic_attachments.world import GridMap
from service.coordination.exploration.greedy_utility import GreedyUtility
from service.coordination.exploration.problem import ExplorationProblem

WIDTH = 60


def problem(costs_s: list[list[float]], target_columns: list[int]) -> ExplorationProblem:
    """Targets in the lowest row of a map of 1 m cells; 5 m sensors, 1 m/s."""
    return ExplorationProblem(
        grid=GridMap(np.zeros((2, WIDTH), np.int8), 1.0),
        robot_cells=np.zeros(len(costs_s), np.int64),
        target_cells=np.array(target_columns, np.int64),
        costs_s=np.array(costs_s),
        sensor_range_m=5.0,
        speed_m_s=1.0,
    )


def test_a_second_robot_goes_further_to_a_fresh_target() -> None:
    # Targets at 0 m and 1 m see the same; the one at 30 m is fresh.
    found = GreedyUtility().assign(problem([[10.0, 11.0, 40.0], [10.0, 11.0, 40.0]], [0, 1, 30]))
    assert sorted(found.values()) == [0, 2]


def test_a_high_price_of_the_way_makes_it_nearest_first() -> None:
    greedy = GreedyUtility(cost_weight=100.0)
    found = greedy.assign(problem([[10.0, 11.0, 40.0], [12.0, 11.0, 40.0]], [0, 1, 30]))
    assert found == {0: 0, 1: 1}


def test_every_robot_that_can_go_anywhere_gets_a_target() -> None:
    found = GreedyUtility().assign(problem([[1.0], [np.inf], [2.0]], [7]))
    assert found == {0: 0, 2: 0}
    assert GreedyUtility().assign(problem([[np.inf]], [7])) == {}
