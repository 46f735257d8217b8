"""Coordination by cost and utility (Burgard, Moors, Stachniss and Schneider, "Coordinated
Multi-Robot Exploration", IEEE Transactions on Robotics 21, 2005, algorithm 1)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from service.coordination.exploration.problem import ExplorationProblem


@dataclass(frozen=True)
class GreedyUtility:
    """Takes the best pair of robot and target, lowers the utility of what is near, and repeats."""

    cost_weight: float = 0.1
    """`beta`: what a way of one sensor range costs, relative to the utility 1 of a fresh target."""

    def assign(self, problem: ExplorationProblem) -> Mapping[int, int]:
        """Robots and targets by utility less cost.

        The utility of a target falls by `1 - d / range` for each target taken at the distance `d`
        within the sensor's range (equation 5 of the paper, without its test of visibility).
        """
        finite = np.isfinite(problem.costs_s)
        if not finite.any():
            return {}
        positions_m = problem.target_positions_m
        utility = np.ones(len(positions_m))
        # In sensor ranges; speeds only scale the travel time.
        metres = problem.costs_s * problem.speed_m_s
        costs = np.where(finite, self.cost_weight * metres / problem.sensor_range_m, np.inf)
        chosen: dict[int, int] = {}
        while np.isfinite(costs).any():
            gain = utility[None, :] - costs
            robot, target = divmod(int(np.argmax(gain)), len(utility))
            chosen[robot] = target
            costs[robot] = np.inf
            apart_m = np.linalg.norm(positions_m - positions_m[target], axis=1)
            utility -= np.clip(1.0 - apart_m / problem.sensor_range_m, 0.0, None)
        return dict(sorted(chosen.items()))
