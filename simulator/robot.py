"""A simulated robot: its body, what it is doing, and how its drive steers towards a point."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from simulator.fleet_client import Command
from simulator.fleet_scenario import Point, Pose, RobotType

_GEAR_CHANGE_S = 0.4
"""how long a car that is held up waits before it changes gear"""

TimedPoint = tuple[float, float, float]
"""Time since the mission began [s], x, y [m]."""


@dataclass(slots=True)
class Robot:
    """State of one robot; poses in the map frame."""

    id: str
    kind: RobotType
    x: float
    y: float
    heading_rad: float
    body: Pose | None = None
    """where it truly is, if that is not where it believes to be"""
    carrier: str | None = None
    """the robot it rides on"""
    activity: str = "idle"
    """one of the fleet protocol's states"""
    command: Command | None = None
    command_over: bool = True
    """the command was finished or given up; the service has not replaced it yet"""
    order: str | None = None
    """id of the service's command that it began with; another one out of contact may have
    followed"""
    began_s: float = 0.0
    busy_until_s: float = math.inf
    halted_until_s: float = -math.inf
    """stands still until then, for a reason of its own"""
    goals: list[Point] = field(default_factory=list)
    """where the command ends; any of them will do"""
    route: list[Point] = field(default_factory=list)
    leg: int = 0
    """index of the route's leg being driven: from `route[leg]` to `route[leg + 1]`"""
    timed: list[TimedPoint] = field(default_factory=list)
    """a motion that gives way to others, instead of the route"""
    waits_since_s: float | None = None
    """since when it has stood still because there is no way to its goals"""
    stalled_s: float = 0.0
    """how long it has wanted to move and could not"""
    gear: int = 1
    """of a car: 1 forwards, -1 backwards"""
    backs_m: float = 0.0
    """how much further a car backs away from what held it up"""
    held_s: float = 0.0
    """how long others have kept it from driving on; it forgets that slowly while it drives"""
    driven_m: float = 0.0

    @property
    def position(self) -> Point:
        """Centre of the body."""
        return (self.x, self.y)

    @property
    def pose(self) -> Pose:
        """Position and heading."""
        return (self.x, self.y, self.heading_rad)

    @property
    def truth(self) -> Pose:
        """Where its body is; the pose is what it believes."""
        return self.body or (self.x, self.y, self.heading_rad)

    @property
    def is_aboard(self) -> bool:
        """Whether it rides on a carrier, without a body of its own in the building."""
        return self.carrier is not None

    @property
    def is_busy(self) -> bool:
        """Whether it is in an action that cannot be interrupted."""
        return self.activity in ("clearing", "docking", "undocking")

    @property
    def has_failed(self) -> bool:
        """Whether it is dead."""
        return self.activity == "failed"

    def is_immovable(self, time_s: float) -> bool:
        """Whether others have to get around it."""
        return self.is_busy or self.has_failed or time_s < self.halted_until_s

    def follow(self, route: list[Point]) -> None:
        """Takes a new route."""
        self.route, self.leg, self.timed, self.waits_since_s = route, 0, [], None

    def stop(self) -> None:
        """Forgets where it was going."""
        self.route, self.leg, self.timed, self.goals = [], 0, [], []
        self.waits_since_s = None


def wrap(angle_rad: float) -> float:
    """The same angle between -pi and pi."""
    return math.remainder(angle_rad, math.tau)


def steer(robot: Robot, towards: Point, limit_m_s: float, step_s: float) -> tuple[float, float]:
    """Speed [m/s], negative for driving backwards, and turn rate [rad/s] towards a point."""
    bearing = math.atan2(towards[1] - robot.y, towards[0] - robot.x)
    error = wrap(bearing - robot.heading_rad)
    if robot.kind.drive == "ackermann":
        return _steer_like_a_car(robot, error, limit_m_s, step_s)
    kind = robot.kind
    turn = max(-kind.turn_rate_rad_s, min(kind.turn_rate_rad_s, error / (3.0 * step_s)))
    if abs(error) > 0.7:
        return 0.0, turn
    speed = min(kind.speed_m_s * math.cos(error) ** 2, limit_m_s)
    return speed, turn


def _steer_like_a_car(
    robot: Robot, error: float, limit_m_s: float, step_s: float
) -> tuple[float, float]:
    """A car turns only as it drives: round a wide corner forwards, in a tight one by backing up.

    It backs up while the point lies far off its course, and changes gear whenever it is held up, so
    that it turns round in several moves where there is no room for one. Backing away from what held
    it up it turns to its right: two that meet head-on then pass one another.
    """
    if robot.held_s > _GEAR_CHANGE_S:
        robot.gear, robot.held_s = -robot.gear, 0.0
        robot.backs_m = robot.kind.turning_radius_m if robot.gear < 0 else 0.0
    elif robot.gear > 0 and abs(error) > 1.0:
        robot.gear = -1
    elif robot.gear < 0 and robot.backs_m <= 0.0 and abs(error) < 0.3:
        robot.gear = 1
    fast_m_s = robot.kind.speed_m_s * (max(0.3, math.cos(error) ** 2) if robot.gear > 0 else 0.4)
    speed = robot.gear * min(fast_m_s, max(limit_m_s, 0.1))
    most = abs(speed) / robot.kind.turning_radius_m
    if robot.gear < 0 and robot.backs_m > 0.0:
        robot.backs_m += speed * step_s
        return speed, -most
    return speed, max(-most, min(most, error / (3.0 * step_s)))
