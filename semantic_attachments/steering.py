"""How a robot gets from one pose to another where nothing is in the way: the local planner of a
roadmap.

Dubins and Reeds-Shepp curves are OMPL's. A pose is (x [m], y [m], heading [rad]) in the map frame.
"""

from math import ceil, hypot, pi
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.robot_model import RobotModel

Pose = tuple[float, float, float]


class Steering(Protocol):
    """The shortest motion between two poses."""

    symmetric: bool
    """Whether the way back takes as long and passes the same poses."""
    headings: int
    """Number of headings tried at a place."""
    is_costly: bool
    """Whether poses along a motion are costly to compute."""

    def duration_s(self, start: Pose, goal: Pose) -> float:
        """Time it takes [s]."""
        ...

    def length_m(self, start: Pose, goal: Pose) -> float:
        """How far points of the outline move at most [m]; for cars, the reference point."""
        ...

    def poses(self, start: Pose, goal: Pose, step_m: float) -> NDArray[np.float64]:
        """(n, 3) poses along it, both ends included, at most a step apart."""
        ...

    def at(self, start: Pose, goal: Pose, shares: tuple[float, ...]) -> NDArray[np.float64]:
        """(n, 3) poses at shares (0 to 1) of its length."""
        ...


class Straight:
    """Drives straight in any direction; a robot whose heading matters turns, too (kind `se2`)."""

    symmetric = True
    is_costly = False

    def __init__(self, model: RobotModel, headings: int) -> None:
        self._speed_m_s = model.speed_m_s
        self._turns = model.kinematics == "se2"
        self._turn_speed_rad_s = model.turn_speed_rad_s
        self._reach_m = max((hypot(x, y) for x, y in model.footprint_m), default=0.0)
        self.headings = headings if self._turns and model.footprint_m else 1

    def duration_s(self, start: Pose, goal: Pose) -> float:
        driving_s = hypot(goal[0] - start[0], goal[1] - start[1]) / self._speed_m_s
        if not self._turns:
            return driving_s
        return driving_s + abs(_turn(start[2], goal[2])) / self._turn_speed_rad_s

    def length_m(self, start: Pose, goal: Pose) -> float:
        length_m = hypot(goal[0] - start[0], goal[1] - start[1])
        if self._turns:
            length_m += abs(_turn(start[2], goal[2])) * self._reach_m
        return length_m

    def poses(self, start: Pose, goal: Pose, step_m: float) -> NDArray[np.float64]:
        count = ceil(self.length_m(start, goal) / step_m) + 1
        return self._along(start, goal, np.linspace(0.0, 1.0, count))

    def at(self, start: Pose, goal: Pose, shares: tuple[float, ...]) -> NDArray[np.float64]:
        return self._along(start, goal, np.array(shares))

    def _along(self, start: Pose, goal: Pose, shares: NDArray[np.float64]) -> NDArray[np.float64]:
        difference = (goal[0] - start[0], goal[1] - start[1], _turn(start[2], goal[2]))
        return np.asarray(np.array(start) + shares[:, None] * np.array(difference))


class Car:
    """Dubins and Reeds-Shepp curves."""

    is_costly = True

    def __init__(self, model: RobotModel, headings: int) -> None:
        from ompl import base

        self.symmetric = model.kinematics == "reeds-shepp"
        self.headings = headings
        kind = base.ReedsSheppStateSpace if self.symmetric else base.DubinsStateSpace
        self.space: Any = kind(model.turning_radius_m)
        self._speed_m_s = model.speed_m_s
        self._ends = (self.space.allocState(), self.space.allocState())
        self._between = self.space.allocState()

    def duration_s(self, start: Pose, goal: Pose) -> float:
        return self.length_m(start, goal) / self._speed_m_s

    def length_m(self, start: Pose, goal: Pose) -> float:
        return float(self.space.distance(*self._set(start, goal)))

    def poses(self, start: Pose, goal: Pose, step_m: float) -> NDArray[np.float64]:
        count = ceil(self.length_m(start, goal) / step_m) + 1
        return self.at(start, goal, tuple(index / max(count - 1, 1) for index in range(count)))

    def at(self, start: Pose, goal: Pose, shares: tuple[float, ...]) -> NDArray[np.float64]:
        first, last = self._set(start, goal)
        poses = np.empty((len(shares), 3))
        state = self._between
        for index, share in enumerate(shares):
            self.space.interpolate(first, last, share, state)
            poses[index] = state.getX(), state.getY(), state.getYaw()
        return poses

    def _set(self, start: Pose, goal: Pose) -> tuple[Any, Any]:
        for state, (x, y, heading) in zip(self._ends, (start, goal), strict=True):
            state.setX(float(x))
            state.setY(float(y))
            state.setYaw(float(heading))
        return self._ends


def steering(model: RobotModel, headings: int) -> Steering:
    """The steering of a robot model."""
    return (Straight if model.kinematics in ("disc", "se2") else Car)(model, headings)


def _turn(start: float, goal: float) -> float:
    return (goal - start + pi) % (2 * pi) - pi
