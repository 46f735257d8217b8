"""`POST /v1/plans`: planning requests without a mission."""

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from service.messages.base import Identifier, Message
from service.messages.mission import MapMessage, RobotTypeMessage

PlanStatus = Literal["queued", "running", "finished", "failed", "canceled"]


class PlanRequest(Message):
    """A problem to solve; the domain is one of the server's, or a text."""

    domain: Identifier | None = None
    domain_text: str | None = None
    problem: str
    map: MapMessage | None = None
    """What the domain's attachments work on; positions are the problem's fluents."""
    robot_types: dict[Identifier, RobotTypeMessage] = Field(default_factory=dict, max_length=100)
    time_limit_s: Annotated[float, Field(gt=0.0, le=3600.0)] = 10.0
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0
    node_limit: Annotated[int, Field(ge=1, le=2**40)] | None = None
    memory_limit_mb: Annotated[int, Field(ge=16, le=65536)] = 1024
    first_plan_only: bool = False
    priority: Annotated[int, Field(ge=0, le=9)] = 0
    """Requests of higher priority go first."""

    @model_validator(mode="after")
    def _one_domain(self) -> "PlanRequest":
        if (self.domain is None) == (self.domain_text is None):
            raise ValueError("give either domain (a name) or domain_text (PDDL), one of them")
        return self


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
