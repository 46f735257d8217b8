"""OMPL's RRT-Connect between two sets of poses, within a time."""

from collections.abc import Callable, Sequence
from functools import cache
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


def connect(
    model: RobotModel,
    grid: GridMap,
    starts: Sequence[Pose],
    goals: Sequence[Pose],
    *,
    is_free: Callable[[float, float, float], bool],
    budget_s: float,
) -> list[Pose]:
    """Poses of a motion from one of the starts to one of the goals that steering joins; none if
    none is found.

    Approximate solutions do not count.
    """
    from ompl import base, geometric

    space = _space(model)
    bounds = base.RealVectorBounds(2)
    extent_m = (grid.width * grid.resolution_m, grid.height * grid.resolution_m)
    for axis in (0, 1):
        bounds.setLow(axis, grid.origin_m[axis])
        bounds.setHigh(axis, grid.origin_m[axis] + extent_m[axis])
    space.setBounds(bounds)
    information = base.SpaceInformation(space)
    information.setStateValidityChecker(
        lambda state: is_free(state.getX(), state.getY(), state.getYaw())
    )
    information.setStateValidityCheckingResolution(grid.resolution_m / 2 / space.getMaximumExtent())
    information.setup()
    found: list[Pose] = []
    # Two headings of each end, opposite ones, are enough: others are reached from there.
    trials = [(ends[0], ends[len(ends) // 2]) for ends in (starts, goals)]
    for start, goal in zip(*trials, strict=True):
        definition = base.ProblemDefinition(information)
        definition.setStartAndGoalStates(_state(space, start), _state(space, goal))
        planner = geometric.RRTConnect(information)
        planner.setProblemDefinition(definition)
        planner.setup()
        planner.solve(budget_s / 2)
        if definition.hasExactSolution():
            path = definition.getSolutionPath()
            states = [path.getState(index) for index in range(path.getStateCount())]
            found = [(state.getX(), state.getY(), state.getYaw()) for state in states]
            break
    return found


def _space(model: RobotModel) -> Any:
    from ompl import base

    if model.kinematics == "reeds-shepp":
        return base.ReedsSheppStateSpace(model.turning_radius_m)
    if model.kinematics == "dubins":
        return base.DubinsStateSpace(model.turning_radius_m)
    return base.SE2StateSpace()


def _state(space: Any, pose: Pose) -> Any:
    state = space.allocState()
    state.setX(pose[0])
    state.setY(pose[1])
    state.setYaw(pose[2])
    return state
