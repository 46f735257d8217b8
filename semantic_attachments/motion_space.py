"""A robot's motions on a map as OMPL sees them: state space, bounds, collision test."""

from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import Any

from semantic_attachments.grid_map import GridMap
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.steering import Pose


@cache
def quiet_and_seeded(seed: int) -> None:
    """Silences OMPL and seeds its random numbers; once a process, before anything else of it."""
    from ompl import util

    util.setLogLevel(util.LogLevel.LOG_NONE)
    util.RNG.setSeed(seed + 1)


class MotionSpace:
    """Sets up OMPL's planners; lengths are in metres (for `se2`, turns count half a metre a
    radian)."""

    def __init__(
        self, model: RobotModel, grid: GridMap, is_free: Callable[[float, float, float], bool]
    ) -> None:
        from ompl import base

        self.space: Any = _space(model)
        bounds = base.RealVectorBounds(2)
        extent_m = (grid.width * grid.resolution_m, grid.height * grid.resolution_m)
        for axis in (0, 1):
            bounds.setLow(axis, grid.origin_m[axis])
            bounds.setHigh(axis, grid.origin_m[axis] + extent_m[axis])
        self.space.setBounds(bounds)
        self.information: Any = base.SpaceInformation(self.space)
        self.information.setStateValidityChecker(
            lambda state: is_free(state.getX(), state.getY(), state.getYaw())
        )
        self.information.setStateValidityCheckingResolution(
            grid.resolution_m / 2 / self.space.getMaximumExtent()
        )
        self.information.setup()

    def problem(self, start: Pose, goal: Pose) -> Any:
        """The problem to get from one pose to another."""
        from ompl import base

        definition = base.ProblemDefinition(self.information)
        definition.setStartAndGoalStates(self.state(start), self.state(goal))
        return definition

    def state(self, pose: Pose) -> Any:
        """A state of OMPL."""
        state = self.space.allocState()
        state.setX(pose[0])
        state.setY(pose[1])
        state.setYaw(pose[2])
        return state

    def length_m(self, poses: list[Pose]) -> float:
        """Length of a motion that steers from pose to pose."""
        states = [self.state(pose) for pose in poses]
        lengths_m = [float(self.space.distance(*ends)) for ends in pairwise(states)]
        return sum(lengths_m)


def solution(definition: Any) -> list[Pose]:
    """Poses of the exact solution; none if there is none: approximate ones do not count."""
    if not definition.hasExactSolution():
        return []
    path = definition.getSolutionPath()
    states = [path.getState(index) for index in range(path.getStateCount())]
    return [(state.getX(), state.getY(), state.getYaw()) for state in states]


def _space(model: RobotModel) -> Any:
    from ompl import base

    if model.kinematics == "reeds-shepp":
        return base.ReedsSheppStateSpace(model.turning_radius_m)
    if model.kinematics == "dubins":
        return base.DubinsStateSpace(model.turning_radius_m)
    return base.SE2StateSpace()
