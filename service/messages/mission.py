"""`POST /v1/missions`: what a fleet tells about itself, its map and its task."""

from typing import Annotated

from pydantic import Field

from service.messages.base import Identifier, Message, Pose, Position, Seconds, Text
from service.messages.map_grid import MapMessage
from service.messages.resource import MapOrReference, Reference


class RobotTypeMessage(Message):
    """What all robots of a type have in common."""

    radius_m: Annotated[float, Field(ge=0.0, le=100.0)]
    speed_m_s: Annotated[float, Field(gt=0.0, le=1000.0)]
    sensor_range_m: Annotated[float, Field(gt=0.0, le=1e5)] = 5.0
    enters: list[Identifier] = Field(default_factory=lambda: ["default"], min_length=1)
    capacity: Annotated[int, Field(ge=0, le=1000)] = 0
    """Rovers that a carrier holds at once."""
    dock_duration_s: Annotated[float, Field(ge=0.0, le=1e5)] = 20.0
    """Time that a rover of this type takes to drive onto a carrier [s]."""
    undock_duration_s: Annotated[float, Field(ge=0.0, le=1e5)] = 10.0
    """Time that it takes to leave a carrier [s]."""


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


class ExplorationMessage(Message):
    """The map is to be explored: frontiers, found as it grows, are targets as well."""

    communication_range_m: Annotated[float, Field(gt=0.0, le=1e6)] | None = None
    """Robots further apart, and not linked by others, are coordinated apart; None for all."""


class PlanningMessage(Message):
    """How much planning a replan may take, and when a new plan takes over."""

    time_limit_s: Annotated[float, Field(gt=0.0, le=60.0)] = 0.3
    node_limit: Annotated[int, Field(ge=1, le=10_000_000)] | None = None
    """Search nodes a replan; makes a mission repeatable where the time limit is not reached."""
    margin: Annotated[float, Field(ge=0.0, le=0.5)] = 0.02
    """A new plan replaces a valid one if it is better by this share of the remaining makespan."""
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0
    priority: Annotated[int, Field(ge=0, le=9)] = 0
    """Missions of a higher priority are planned first when planners are busy."""


class Task(Message):
    """What a mission is about, apart from domain and map."""

    name: Text
    fleet: Identifier = "default"
    """Whose mission it is; keys may be limited to fleets."""
    strategy: Identifier = "planner"
    robot_types: Annotated[dict[Identifier, RobotTypeMessage], Field(min_length=1, max_length=100)]
    robots: Annotated[list[RobotMessage], Field(min_length=1, max_length=1000)]
    targets: Annotated[list[TargetMessage], Field(max_length=10_000)]
    exploration: ExplorationMessage | None = None
    planning: PlanningMessage = PlanningMessage()
    lease_s: Seconds = 30.0
    """A robot missing from the reports for longer is planned around until it reports again [s]."""
    commands_ahead: Annotated[int, Field(ge=0, le=20)] = 0
    """How many further commands each robot gets beside its own, for when it is out of contact."""


class MissionRequest(Task):
    """A mission as the fleet asks for it: domain and map may be names of what the service keeps."""

    domain: Reference
    map: MapOrReference


class CreateMission(Task):
    """A mission with the map and the domain that it keeps as long as it lasts."""

    domain: Identifier
    """The formulation: how its problems are posed and its plans are read."""
    map: MapMessage
