"""`POST /v1/plans`: planning requests without a mission."""

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from service.messages.base import Identifier, Message
from service.messages.map_grid import MapMessage
from service.messages.mission import RobotTypeMessage
from service.messages.resource import MapOrReference, Reference

PlanStatus = Literal["queued", "running", "finished", "failed", "canceled"]


class PlanTask(Message):
    """A problem to solve, apart from domain and map."""

    problem: str
    robot_types: dict[Identifier, RobotTypeMessage] = Field(default_factory=dict, max_length=100)
    time_limit_s: Annotated[float, Field(gt=0.0, le=3600.0)] = 10.0
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0
    node_limit: Annotated[int, Field(ge=1, le=2**40)] | None = None
    memory_limit_mb: Annotated[int, Field(ge=16, le=65536)] = 1024
    first_plan_only: bool = False
    priority: Annotated[int, Field(ge=0, le=9)] = 0
    """Requests of higher priority go first."""


class PlanSubmission(PlanTask):
    """`POST /v1/plans`: the domain is one that the service keeps, or a text."""

    domain: Reference | None = None
    domain_text: str | None = None
    map: MapOrReference | None = None
    """What the domain's attachments work on; positions are the problem's fluents."""

    @model_validator(mode="after")
    def _one_domain(self) -> "PlanSubmission":
        if (self.domain is None) == (self.domain_text is None):
            raise ValueError("give either domain (a name) or domain_text (PDDL), one of them")
        return self


class PlanRequest(PlanTask):
    """A problem to solve, complete."""

    domain: Identifier | None = None
    """A built-in domain, in requests stored by older versions."""
    domain_text: str | None = None
    map: MapMessage | None = None


class StepOut(Message):
    """An action with its start and duration [s]."""

    start: float
    action: str
    args: list[str]
    duration: float | None


class PlanOut(Message):
    """A plan that the validator accepted."""

    makespan: float
    metric: float | None
    wall_s: float | None
    cpu_s: float | None
    steps: list[StepOut]
    text: str


class PlanResult(Message):
    """A planning request and what has come of it so far."""

    id: str
    status: PlanStatus
    outcome: str | None = None
    """How planning ended, as in the planner's table of outcomes."""
    message: str | None = None
    """Why it failed."""
    plan: PlanOut | None = None
    """The best plan so far."""
    validated: bool = False
    plans_found: int = 0
    lower_bound: float | None = None
    gap: float | None = None
    statistics: dict[str, Any] | None = None
