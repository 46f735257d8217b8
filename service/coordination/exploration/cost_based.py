"""Assignment by travel costs alone, without regard to the structure of the building."""

from collections.abc import Mapping

import numpy as np

from service.coordination.assignment import hungarian, nearest_pairs
from service.coordination.exploration.problem import ExplorationProblem


class HungarianCosts:
    """The assignment of least total travel time (Wurm, section 2.3; Ko et al., IROS 2003).

    With more robots than targets, targets are shared.
    """

    def assign(self, problem: ExplorationProblem) -> Mapping[int, int]:
        """The Hungarian method on the targets and the robots that can get to any of them."""
        able = np.flatnonzero(np.isfinite(problem.costs_s).any(axis=1)).tolist()
        found = hungarian(problem.costs_s[able].tolist(), share=True)
        return {able[row]: column for row, column in found.items()}


class NearestFrontier:
    """Each robot to the nearest frontier that is not assigned to another robot yet.

    The baseline of Wurm, section 2.6.1. Strong reading: the robot and the target that are nearest
    to one another come first, so that the order of the robots does not matter.
    """

    def assign(self, problem: ExplorationProblem) -> Mapping[int, int]:
        """Pairs of robots and targets, nearest first."""
        return nearest_pairs(problem.costs_s.tolist(), share=True)
