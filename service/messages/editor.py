"""What PDDL editors send; their clients differ, so unknown fields are let through."""

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class EditorMessage(BaseModel):
    """A body of somebody else's protocol."""

    model_config = ConfigDict(extra="ignore", frozen=True)


class SolveBody(EditorMessage):
    """`POST /solve`."""

    domain: str
    problem: str


class PackageSolveBody(SolveBody):
    """`POST /package/{planner}/solve`; numbers may come as text."""

    time_limit: float = Field(default=10.0, gt=0.0, le=3600.0)
    seed: int = Field(default=0, ge=0, le=2**32 - 1)


class CheckBody(EditorMessage):
    """`POST /check/{id}`."""

    adaptor: str | None = None


class PddlFile(EditorMessage):
    """A file in `POST /request`."""

    name: str = ""
    content: str


class Configuration(EditorMessage):
    """How `POST /request` wants to be planned for."""

    timeout: float | None = Field(default=None, gt=0.0, le=3600.0)


class RequestBody(EditorMessage):
    """`POST /request`."""

    domain: PddlFile
    problem: PddlFile
    configuration: Configuration = Configuration()


class ParseBody(EditorMessage):
    """`POST /parse`."""

    domain: str
    problems: list[str] = Field(default_factory=list, max_length=100)


class ValidateBody(EditorMessage):
    """`POST /validate`."""

    domain: str
    problem: str
    plan: str


Json = dict[str, Any]
