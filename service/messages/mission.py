"""`POST /v1/missions`: what a fleet tells about itself, its map and its task."""

from typing import Annotated, Literal

from pydantic import Field

from service.messages.base import Coordinate, Identifier, Message, Pose, Position, Seconds, Text


class MapMessage(Message):
    """An occupancy grid: `int8` cells from the bottom row, zlib in base64."""

    resolution_m: Annotated[float, Field(ge=0.001, le=100.0)]
    origin_m: tuple[Coordinate, Coordinate]
    width: Annotated[int, Field(ge=1, le=100_000)]
    height: Annotated[int, Field(ge=1, le=100_000)]
    encoding: Literal["zlib+base64"] = "zlib+base64"
    cells: str
    terrain: str | None = None
    """`uint8` cells in the same encoding: an index into `terrain_classes`."""
    terrain_classes: list[Identifier] = Field(
        default_factory=lambda: ["default"], min_length=1, max_length=255
    )


class RobotTypeMessage(Message):
    """What all robots of a type have in common."""

    radius_m: Annotated[float, Field(ge=0.0, le=100.0)]
    speed_m_s: Annotated[float, Field(gt=0.0, le=1000.0)]
    sensor_range_m: Annotated[float, Field(gt=0.0, le=1e5)] = 5.0
    enters: list[Identifier] = Field(default_factory=lambda: ["default"], min_length=1)
    capacity: Annotated[int, Field(ge=0, le=1000)] = 0
    """Rovers that a carrier holds at once."""


class RobotMessage(Message):
    """A robot at the start of a mission."""

    id: Identifier
    type: Identifier
    pose: Pose
    carrier: Identifier | None = None


class TargetMessage(Message):
    """A place to visit."""

    id: Identifier
    position_m: Position


class PlanningMessage(Message):
    """How much planning a replan may take, and when a new plan takes over."""

    time_limit_s: Annotated[float, Field(gt=0.0, le=60.0)] = 0.3
    node_limit: Annotated[int, Field(ge=1, le=10_000_000)] | None = None
    """Search nodes a replan; makes a mission repeatable where the time limit is not reached."""
    margin: Annotated[float, Field(ge=0.0, le=0.5)] = 0.02
    """A new plan replaces a valid one if it is better by this share of the remaining makespan."""
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0


class CreateMission(Message):
    """A mission as the fleet asks for it."""

    name: Text
    fleet: Identifier = "default"
    """Whose mission it is; keys may be limited to fleets."""
    domain: Identifier
    strategy: Identifier = "planner"
    map: MapMessage
    robot_types: Annotated[dict[Identifier, RobotTypeMessage], Field(min_length=1, max_length=100)]
    robots: Annotated[list[RobotMessage], Field(min_length=1, max_length=1000)]
    targets: Annotated[list[TargetMessage], Field(max_length=10_000)]
    planning: PlanningMessage = PlanningMessage()
    lease_s: Seconds = 30.0
    """A robot missing from the reports for longer is planned around until it reports again [s]."""
