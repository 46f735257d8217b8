"""`POST /v1/missions/{id}/reports`: what a fleet sees and does, and the commands in answer."""

from typing import Annotated, Literal

from pydantic import Field

from service.messages.base import Identifier, Message, Pose, Position, Seconds, Text

RobotActivity = Literal["idle", "driving", "clearing", "docking", "undocking", "docked", "failed"]
CommandKind = Literal["move", "explore", "clear", "dock", "undock", "wait"]
MissionStatus = Literal["queued", "underway", "delayed", "completed", "failed", "canceled"]
CommandId = Annotated[str, Field(min_length=1, max_length=100)]


class RobotReport(Message):
    """Where a robot is and what it does."""

    id: Identifier
    pose: Pose
    state: RobotActivity
    command: CommandId | None = None
    """The command that it executes."""
    busy_until_s: Seconds | None = None
    """When an action that cannot be interrupted is expected to end."""


class BlockadeReport(Message):
    """A blockade that a robot has sensed."""

    id: Identifier
    segment_m: tuple[Position, Position]
    clear_duration_s: Seconds


class MapPatch(Message):
    """A rectangle of the map as a robot has sensed it; -1 is what it has not."""

    row: Annotated[int, Field(ge=0, le=100_000)]
    """Of its lower left cell; rows count from the bottom of the map."""
    column: Annotated[int, Field(ge=0, le=100_000)]
    width: Annotated[int, Field(ge=1, le=100_000)]
    height: Annotated[int, Field(ge=1, le=100_000)]
    encoding: Literal["zlib+base64"] = "zlib+base64"
    cells: str
    """`int8` cells from its bottom row, as in the mission's map."""
    terrain: str | None = None
    """`uint8` indices into the map's `terrain_classes`; they count where `cells` is not -1."""


class FinishedCommand(Message):
    """A command that a robot has carried out."""

    robot: Identifier
    command: CommandId
    time_s: Seconds | None = None
    """When, if that could not be told at once."""
    position_m: Position | None = None
    """Where the robot was then."""


class FailedCommand(Message):
    """A command that a robot has given up."""

    robot: Identifier
    command: CommandId
    reason: Text = ""
    time_s: Seconds | None = None
    """When, if that could not be told at once."""
    position_m: Position | None = None
    """Where the robot was then."""


class Report(Message):
    """One report of a fleet."""

    sequence: Annotated[int, Field(ge=0, le=2**53)]
    time_s: Seconds
    robots: list[RobotReport] = Field(default_factory=list, max_length=1000)
    blockades: list[BlockadeReport] = Field(default_factory=list, max_length=1000)
    map_patches: list[MapPatch] = Field(default_factory=list, max_length=100)
    """Later ones win where they overlap."""
    finished: list[FinishedCommand] = Field(default_factory=list, max_length=1000)
    failed: list[FailedCommand] = Field(default_factory=list, max_length=1000)


class FollowUp(Message):
    """What a robot does next of its own accord if it is out of contact when it has finished."""

    id: CommandId
    kind: CommandKind
    location: str | None = None
    partner: Identifier | None = None
    position_m: Position | None = None
    """Of the location, unless it is a blockade."""


class Command(Message):
    """An order to one robot; its id stays the same as long as the order does."""

    id: CommandId
    robot: Identifier
    kind: CommandKind
    location: str | None = None
    partner: Identifier | None = None
    path_m: list[Position] = Field(default_factory=list)
    expected_duration_s: Seconds | None = None
    revision: int
    then: list[FollowUp] = Field(default_factory=list)


class MissionSummary(Message):
    """The part of a mission that every report's answer carries."""

    id: str
    status: MissionStatus
    revision: int
    sequence: int
    """The highest sequence number accepted so far; -1 before the first report."""
    targets_left: int
    replans: int


class ReportAnswer(Message):
    """The answer to a report: every robot's current command."""

    mission: MissionSummary
    commands: list[Command]
