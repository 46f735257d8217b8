"""A mission at one instant: what a domain's formulation turns into a planning problem.

Positions are in the map frame [m], headings in radians, times in seconds since the mission began.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

PositionM = tuple[float, float]


class Activity(StrEnum):
    """What a robot is doing, as far as planning is concerned."""

    FREE = "free"
    """Idle or driving: it can be given another order at once."""
    CLEARING = "clearing"
    """Removes the blockade `RobotState.partner`; cannot be interrupted before `free_at_s`."""
    DOCKING = "docking"
    """Drives onto the carrier `RobotState.partner` (a carrier: takes that rover aboard)."""
    UNDOCKING = "undocking"
    """Leaves the carrier `RobotState.partner` (a carrier: puts that rover down)."""
    DOCKED = "docked"
    """Rides on the carrier `RobotState.partner`."""
    FAILED = "failed"
    """Takes no part until it reports again."""


@dataclass(frozen=True, slots=True)
class RobotState:
    """One robot."""

    id: str
    type: str
    """Name of its robot type, which is also its PDDL type."""
    position_m: PositionM
    activity: Activity = Activity.FREE
    partner: str | None = None
    """The other robot of docking and undocking, or the blockade being cleared."""
    arrived_at: str | None = None
    """The location that its last movement led to, while it has not left again."""
    free_at_s: float = 0.0
    """When an activity that cannot be interrupted is expected to end."""


@dataclass(frozen=True, slots=True)
class Target:
    """A place that has to be visited."""

    id: str
    position_m: PositionM
    unknown_m2: float = 0.0
    """Area that is expected to be seen from there for the first time [m^2]."""


@dataclass(frozen=True, slots=True)
class BlockadeState:
    """A known blockade that is not cleared yet."""

    id: str
    segment_m: tuple[PositionM, PositionM]
    clear_duration_s: float

    @property
    def centre_m(self) -> PositionM:
        """The middle of its segment."""
        (x0, y0), (x1, y1) = self.segment_m
        return ((x0 + x1) / 2, (y0 + y1) / 2)


@dataclass(frozen=True, slots=True)
class MeetingPoint:
    """A place on the border between two kinds of terrain where carriers and rovers meet."""

    id: str
    position_m: PositionM


@dataclass(frozen=True, slots=True)
class MissionState:
    """Everything a formulation needs beside the `World` (map and robot models)."""

    time_s: float
    robots: tuple[RobotState, ...]
    targets: tuple[Target, ...]
    """Targets not visited yet."""
    blockades: tuple[BlockadeState, ...] = ()
    meeting_points: tuple[MeetingPoint, ...] = ()
    capacities: Mapping[str, int] = field(default_factory=dict)
    """Rovers each carrier can hold, by robot id."""
