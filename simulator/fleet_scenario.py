"""What a simulation is given: the building, the fleet, the targets and the hidden blockades.

Everything here is plain and frozen; reading it from a file is the business of whoever starts a
simulation. Positions are metres in the map frame, headings radians counter-clockwise, times seconds
since the mission began.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

Point = tuple[float, float]
Pose = tuple[float, float, float]
Segment = tuple[Point, Point]

DRIVES = ("differential", "ackermann")
MARGIN_M = 0.03
"""Distance that routes keep from walls, blockades and standing robots beyond a robot's radius."""


class ScenarioError(ValueError):
    """A scenario that contradicts itself; the message says where and how to mend it."""


@dataclass(frozen=True, slots=True)
class RobotType:
    """Body, drive and senses of a kind of robot."""

    name: str
    radius_m: float = 0.3
    speed_m_s: float = 1.0
    turn_rate_rad_s: float = 2.0
    """Fastest turn on the spot of a differential drive."""
    drive: str = "differential"
    """One of `DRIVES`; an Ackermann drive is steered like a car and cannot turn on the spot."""
    turning_radius_m: float = 0.8
    """Least radius of an Ackermann drive's turns."""
    sensor_range_m: float = 5.0
    beams: int = 180
    """Beams of the laser range finder, spread evenly over the full circle."""
    enters: tuple[str, ...] = ("default",)
    """Terrain classes that this type may drive on."""
    capacity: int = 0
    """How many robots it can carry."""

    def __post_init__(self) -> None:
        if self.drive not in DRIVES:
            raise ScenarioError(
                f"robot type {self.name!r}: drive must be one of {', '.join(DRIVES)}, "
                f"not {self.drive!r}"
            )
        for quantity in (
            "radius_m",
            "speed_m_s",
            "turn_rate_rad_s",
            "turning_radius_m",
            "sensor_range_m",
        ):
            if not getattr(self, quantity) > 0:
                raise ScenarioError(
                    f"robot type {self.name!r}: {quantity} must be positive, "
                    f"not {getattr(self, quantity)!r}"
                )
        if self.beams < 8:
            raise ScenarioError(f"robot type {self.name!r}: beams must be 8 or more")


@dataclass(frozen=True, slots=True)
class RobotStart:
    """A robot and where it begins."""

    id: str
    type: str
    pose: Pose
    carrier: str | None = None
    """The robot it rides on at the start."""


@dataclass(frozen=True, slots=True)
class Target:
    """A place that somebody has to visit."""

    id: str
    position_m: Point


@dataclass(frozen=True, slots=True)
class HiddenBlockade:
    """An obstacle across a passage; the fleet learns of it only by sensing it."""

    id: str
    segment_m: Segment
    clear_duration_s: float


@dataclass(frozen=True, slots=True)
class Noise:
    """Standard deviations of sensing; zero switches a noise off."""

    laser_range_m: float = 0.0
    odometry_m: float = 0.0
    """of the position after a metre driven [m]; it grows with the square root of the way"""
    odometry_rad: float = 0.0
    """of the heading after a radian turned [rad]; it grows with the square root of the turns"""
    odometry_rad_per_m: float = 0.0
    """of the heading after a metre driven [rad]"""


@dataclass(frozen=True, slots=True)
class Communication:
    """How far the robots' radios reach."""

    range_m: float
    """robots, and the service's own radio, hear one another this far, and pass on what they hear"""
    base_m: Point | None = None
    """where the service's own radio stands; None for where the first robot starts"""
    lease_s: float = 600.0
    """for how long the service shall reckon with a robot that it does not hear"""

    def __post_init__(self) -> None:
        for quantity in ("range_m", "lease_s"):
            if not getattr(self, quantity) > 0:
                raise ScenarioError(
                    f"communication: {quantity} must be positive, not {getattr(self, quantity)!r}"
                )


@dataclass(frozen=True, slots=True)
class Failure:
    """A robot that dies (`duration_s` is None) or stands still for a while, at a given time."""

    robot: str
    time_s: float
    duration_s: float | None = None


@dataclass(frozen=True, slots=True)
class Planning:
    """How much planning the service shall spend on a replan."""

    time_limit_s: float = 0.3
    node_limit: int | None = None
    """Search nodes a replan; with it a mission repeats."""
    margin: float = 0.02
    """Share of the remaining makespan by which a new plan must be better to replace a valid one."""


@dataclass(frozen=True, slots=True)
class FleetScenario:
    """One mission of one fleet in one building."""

    name: str
    map_path: Path
    """A ROS map_server YAML file."""
    robot_types: tuple[RobotType, ...]
    robots: tuple[RobotStart, ...]
    targets: tuple[Target, ...] = ()
    blockades: tuple[HiddenBlockade, ...] = ()
    blockades_known: bool = False
    """The fleet knows all blockades when it starts: the bound of what sensing them could give."""
    domain: str = "disaster"
    strategy: str = "planner"
    planning: Planning = field(default_factory=Planning)
    seed: int = 0
    explores: bool = False
    """The map is unknown at first, and what is reported of it is all that the service knows."""
    dock_duration_s: float = 10.0
    undock_duration_s: float = 10.0
    time_limit_s: float = 7200.0
    """Simulated time after which the mission counts as not finished."""
    report_period_s: float = 5.0
    """Longest simulated time between two reports to the service."""
    scan_period_s: float = 0.2
    noise: Noise = field(default_factory=Noise)
    communication: Communication | None = None
    """None for radios that reach everywhere"""
    failures: tuple[Failure, ...] = ()

    def __post_init__(self) -> None:
        types = _unique("robot type", (t.name for t in self.robot_types))
        robots = _unique("robot", (r.id for r in self.robots))
        _unique("target", (t.id for t in self.targets))
        _unique("blockade", (b.id for b in self.blockades))
        if not robots:
            raise ScenarioError("a scenario needs at least one robot: add one to `robots`")
        for robot in self.robots:
            if robot.type not in types:
                raise ScenarioError(
                    f"robot {robot.id!r} has the unknown type {robot.type!r}: "
                    f"use one of {', '.join(sorted(types))}, or define it"
                )
            if robot.carrier is not None and robot.carrier not in robots:
                raise ScenarioError(
                    f"robot {robot.id!r} rides on {robot.carrier!r}, which is not in the fleet"
                )
        for carrier in self.robots:
            riders = [r.id for r in self.robots if r.carrier == carrier.id]
            capacity = self.type_of(carrier).capacity
            if len(riders) > capacity:
                raise ScenarioError(
                    f"robot {carrier.id!r} starts with {len(riders)} riders ({', '.join(riders)}) "
                    f"but its type {carrier.type!r} has capacity {capacity}"
                )
        for blockade in self.blockades:
            if math.dist(*blockade.segment_m) <= 0 or blockade.clear_duration_s < 0:
                raise ScenarioError(
                    f"blockade {blockade.id!r} needs two different end points "
                    "and a clear_duration_s of 0 or more"
                )
        for failure in self.failures:
            if failure.robot not in robots:
                raise ScenarioError(f"a failure names the unknown robot {failure.robot!r}")

    def type_of(self, robot: RobotStart) -> RobotType:
        """The type of a robot of this fleet."""
        return next(t for t in self.robot_types if t.name == robot.type)


def _unique(kind: str, names: Iterable[str]) -> set[str]:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise ScenarioError(f"two {kind}s are called {name!r}: give each a name of its own")
        seen.add(name)
    return seen
