"""`GET /v1/missions/{id}` and `/plan`: what a mission tells about itself."""

from service.messages.base import Identifier, Message, Pose, Position, Seconds
from service.messages.instruction import InstructionStatus
from service.messages.report import MissionStatus, RobotActivity
from service.messages.resource import UsedResource


class PlanStep(Message):
    """An action with its start and duration [s]."""

    start_s: float
    action: str
    arguments: list[str]
    duration_s: float | None = None


class PlanInForce(Message):
    """The plan in force; starts count from the beginning of the mission."""

    revision: int
    steps: list[PlanStep]
    makespan_s: float
    """Mission time at which the last step ends."""
    validated: bool
    """Whether the independent validator accepted the plan; false for one-step assignments."""


class RobotStatus(Message):
    """A robot as the service knows it."""

    id: Identifier
    type: Identifier
    pose: Pose
    state: RobotActivity
    lost: bool
    """Silent for longer than its lease."""
    left: bool
    """Taken out of the mission."""
    taken_over: bool
    """Driven by a person."""
    carrier: str | None
    command: str | None
    reported_at_s: Seconds


class TargetStatus(Message):
    """A target and who visited it."""

    id: Identifier
    position_m: Position
    visited_by: str | None
    visited_at_s: float | None
    removed: bool


class BlockadeStatus(Message):
    """A blockade and who cleared it."""

    id: Identifier
    segment_m: tuple[Position, Position]
    clear_duration_s: Seconds
    seen_at_s: Seconds
    cleared_by: str | None
    cleared_at_s: float | None


class Decision(Message):
    """What was decided, when and why."""

    time_s: float
    revision: int
    kind: str
    reason: str


class MissionDetail(Message):
    """A mission in full."""

    id: str
    name: str
    fleet: str
    domain: str
    resources: list[UsedResource]
    """Versions of domains and maps that it keeps until it ends."""
    strategy: str
    status: MissionStatus
    status_reason: str
    time_s: float
    revision: int
    sequence: int
    targets_left: int
    replans: int
    robots: list[RobotStatus]
    targets: list[TargetStatus]
    blockades: list[BlockadeStatus]
    instructions: list[InstructionStatus]
    decisions: list[Decision]
    """The latest 200."""


class KnownMap(Message):
    """The map with all known, uncleared blockades drawn in as occupied cells."""

    resolution_m: float
    origin_m: Position
    width: int
    height: int
    encoding: str
    cells: str
    terrain: str | None
    terrain_classes: list[str]
    blockades: list[BlockadeStatus]
