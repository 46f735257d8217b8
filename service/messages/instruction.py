"""What a person tells a mission to do (thesis 7.2.1): the next plan obeys or says why it cannot."""

from typing import Annotated, Literal

from pydantic import Field, RootModel

from service.messages.base import Identifier, Message, Seconds


class Pin(Message):
    """Nobody else goes there."""

    kind: Literal["pin"]
    robot: Identifier
    location: Identifier
    """A target or a blockade."""


class Forbid(Message):
    """This robot does not go there."""

    kind: Literal["forbid"]
    robot: Identifier
    location: Identifier


class Priority(Message):
    """Targets of higher priority are visited first; those without one have priority 0."""

    kind: Literal["priority"]
    target: Identifier
    priority: Annotated[int, Field(ge=1, le=100)]


class Deadline(Message):
    """A target is to be visited before a time of the mission."""

    kind: Literal["deadline"]
    target: Identifier
    time_s: Seconds


class TakeOver(Message):
    """A person drives this robot; the mission plans without it."""

    kind: Literal["take-over"]
    robot: Identifier


Instruction = Annotated[Pin | Forbid | Priority | Deadline | TakeOver, Field(discriminator="kind")]


class InstructionBody(RootModel[Instruction]):
    """The body of `POST /v1/missions/{id}/instructions`."""


class InstructionStatus(Message):
    """An instruction in force and what became of it."""

    id: str
    instruction: Instruction
    given_at_s: float
    remark: str
    """Why the plan in force cannot obey; empty if it does."""
