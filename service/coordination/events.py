"""What can happen to a mission; its state is the fold of these over time.

Each event is stored before anybody hears of it, so that a mission rebuilt from the log is the
mission that was acknowledged.
"""

from typing import Annotated, Literal

from pydantic import Field, TypeAdapter

from service.messages.base import Message, Seconds
from service.messages.instruction import Instruction
from service.messages.mission import CreateMission, RobotMessage, TargetMessage
from service.messages.plan import PlanStep
from service.messages.report import Command, Report
from service.messages.resource import UsedResource

TerminalStatus = Literal["completed", "failed", "canceled"]


class MissionCreated(Message):
    """A mission was accepted."""

    kind: Literal["mission-created"] = "mission-created"
    id: str
    request: CreateMission
    idempotency_key: str | None = None
    body_digest: str | None = None
    """SHA-256 of the request, to tell a repetition from another mission under the same key."""
    domain_text: str | None = None
    """The PDDL that it plans with until it ends; None in logs older than versioned domains."""
    resources: list[UsedResource] = Field(default_factory=list)
    """Versions of domains and maps that it uses."""


class ReportAccepted(Message):
    """A report of the fleet was accepted."""

    kind: Literal["report-accepted"] = "report-accepted"
    report: Report


class OrdersIssued(Message):
    """The commands in force changed, with or without a new plan behind them."""

    kind: Literal["orders-issued"] = "orders-issued"
    time_s: Seconds
    revision: int
    reason: str
    """What made the service plan, and why this plan."""
    commands: list[Command]
    """The current command of every robot that has one."""
    new_plan: bool
    steps: list[PlanStep] = Field(default_factory=list)
    """The new plan, starts in mission time; empty if the plan in force goes on."""
    validated: bool = False
    remarks: dict[str, str] = Field(default_factory=dict)
    """Why instructions cannot be obeyed, by instruction id."""
    done: list[Command] = Field(default_factory=list)
    """Commands that were carried out while the new plan was being made: it may hold them again."""
    disturbed: bool = False
    """While the new plan was being made something happened that it does not reckon with."""


class FrontiersFound(Message):
    """The map has grown: these are the places from which more of it can be seen."""

    kind: Literal["frontiers-found"] = "frontiers-found"
    time_s: Seconds
    targets: list[TargetMessage]
    """All that are left; those of before keep their ids as long as they are there."""


class PlanKept(Message):
    """A replan changed nothing."""

    kind: Literal["plan-kept"] = "plan-kept"
    time_s: Seconds
    reason: str
    remarks: dict[str, str] = Field(default_factory=dict)
    """Why instructions cannot be obeyed, by instruction id."""


class PlanningFailed(Message):
    """A replan found no plan."""

    kind: Literal["planning-failed"] = "planning-failed"
    time_s: Seconds
    reason: str
    hopeless: bool = False
    """As far as is known there is nothing that the team can do."""
    remarks: dict[str, str] = Field(default_factory=dict)
    """Why instructions cannot be obeyed, by instruction id."""


class CommandGivenUp(Message):
    """A robot was so late, and stood still, that its command counts as failed."""

    kind: Literal["command-given-up"] = "command-given-up"
    time_s: Seconds
    robot: str
    command: str
    reason: str


class RobotLost(Message):
    """A robot's lease ran out: it is planned around until it reports again."""

    kind: Literal["robot-lost"] = "robot-lost"
    time_s: Seconds
    robot: str


class RobotJoined(Message):
    """A robot joined the mission, or came back after it had left."""

    kind: Literal["robot-joined"] = "robot-joined"
    time_s: Seconds
    robot: RobotMessage


class RobotLeft(Message):
    """A robot left the mission."""

    kind: Literal["robot-left"] = "robot-left"
    time_s: Seconds
    robot: str


class TargetAdded(Message):
    """There is one more place to visit."""

    kind: Literal["target-added"] = "target-added"
    time_s: Seconds
    target: TargetMessage


class TargetRemoved(Message):
    """A target need not be visited any more."""

    kind: Literal["target-removed"] = "target-removed"
    time_s: Seconds
    target: str


class InstructionGiven(Message):
    """A person told the mission to do something."""

    kind: Literal["instruction-given"] = "instruction-given"
    time_s: Seconds
    id: str
    instruction: Instruction


class InstructionWithdrawn(Message):
    """An instruction no longer counts."""

    kind: Literal["instruction-withdrawn"] = "instruction-withdrawn"
    time_s: Seconds
    id: str


class MissionClosed(Message):
    """The mission reached its one terminal state."""

    kind: Literal["mission-closed"] = "mission-closed"
    time_s: Seconds
    status: TerminalStatus
    reason: str


Event = Annotated[
    MissionCreated
    | ReportAccepted
    | OrdersIssued
    | FrontiersFound
    | PlanKept
    | PlanningFailed
    | CommandGivenUp
    | RobotLost
    | RobotJoined
    | RobotLeft
    | TargetAdded
    | TargetRemoved
    | InstructionGiven
    | InstructionWithdrawn
    | MissionClosed,
    Field(discriminator="kind"),
]
_EVENT: TypeAdapter[Event] = TypeAdapter(Event)


def to_json(event: Event) -> str:
    """The event as it is stored."""
    return event.model_dump_json()


def from_json(text: str) -> Event:
    """Reads what `to_json` wrote."""
    return _EVENT.validate_json(text)
