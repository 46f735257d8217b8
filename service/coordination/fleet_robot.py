"""A robot of a fleet as its mission knows it."""

from dataclasses import dataclass
from math import hypot

from service.coordination.meeting_points import is_meeting_point
from service.messages.base import Pose, Position
from service.messages.mission import RobotMessage
from service.messages.report import RobotActivity

ARRIVAL_TOLERANCE_M = 0.5
"""A robot that has moved further than this has left the place where it arrived."""
MEETING_TOLERANCE_M = 1.5
"""Robots that meet make room for one another: so near the point they are still there [m]."""


@dataclass(slots=True)
class FleetRobot:
    """A robot as last reported."""

    id: str
    type: str
    pose: Pose
    state: RobotActivity = "idle"
    command: str | None = None
    busy_until_s: float | None = None
    carrier: str | None = None
    arrived_at: str | None = None
    """Where its last movement ended, until it moves on."""
    arrival_pose: Pose = (0.0, 0.0, 0.0)
    reported_at_s: float = 0.0
    still_since_s: float = 0.0
    """It has not left `still_pose` since."""
    still_pose: Pose = (0.0, 0.0, 0.0)
    lost: bool = False
    """It has been silent for longer than its lease."""
    left: bool = False
    """It was taken out of the mission."""
    taken_over: bool = False
    """A person drives it."""

    @property
    def takes_part(self) -> bool:
        """Whether it can be planned with."""
        return not (self.lost or self.left or self.taken_over) and self.state != "failed"

    @property
    def position_m(self) -> Position:
        """Where it is in the map frame."""
        return self.pose[0], self.pose[1]


def fleet_robot(robot: RobotMessage, time_s: float) -> FleetRobot:
    """A robot as it joins at mission time `time_s` [s]."""
    return FleetRobot(
        robot.id,
        robot.type,
        robot.pose,
        state="idle" if robot.carrier is None else "docked",
        carrier=robot.carrier,
        reported_at_s=time_s,
        still_since_s=time_s,
        still_pose=robot.pose,
    )


def apart(one: Pose, other: Pose, tolerance_m: float = ARRIVAL_TOLERANCE_M) -> bool:
    """Whether two poses are different places."""
    return hypot(one[0] - other[0], one[1] - other[1]) > tolerance_m


def has_left(robot: FleetRobot) -> bool:
    """Whether a robot is not any more where its last movement led to."""
    meets = is_meeting_point(robot.arrived_at)
    tolerance_m = MEETING_TOLERANCE_M if meets else ARRIVAL_TOLERANCE_M
    return apart(robot.pose, robot.arrival_pose, tolerance_m)
