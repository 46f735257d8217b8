"""Findings about PDDL and plan texts, and the exceptions of the planner."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import ClassVar

from planner._core import Diagnostic, Panic
from planner.outcome import Outcome

__all__ = ["AttachmentError", "Diagnostic", "InternalError", "PddlError", "PlannerError"]


class PlannerError(Exception):
    """Anything that stops the planner; `outcome` gives exit code and HTTP status."""

    outcome: ClassVar[Outcome] = Outcome.INTERNAL_ERROR


class InternalError(PlannerError):
    """The planner contradicted itself: a panic, or a plan that its own validator rejects."""


@contextmanager
def without_panics() -> Iterator[None]:
    """Turns a panic of the core into an `InternalError`."""
    try:
        yield
    except Panic as panic:
        raise InternalError(f"{panic}; please report it with the domain and problem") from None


class PddlError(PlannerError):
    """A domain, problem or plan that cannot be used."""

    outcome = Outcome.INPUT_ERROR
    diagnostics: tuple[Diagnostic, ...]
    """All findings of the text, errors and warnings."""

    def __init__(self, diagnostics: Sequence[Diagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        errors = [one for one in self.diagnostics if one.severity == "error"]
        super().__init__("\n".join(one.rendered for one in errors))


class AttachmentError(PlannerError):
    """An attachment that is missing or failed; it stops planning and never becomes a wrong plan.

    The exception that it raised, if any, is the `__cause__`.
    """

    outcome = Outcome.ATTACHMENT_ERROR
    module: str
    """The module's name."""
    arguments: tuple[str, ...]
    """The arguments of the call."""
    action: str
    """The action that needed it."""

    def __init__(self, module: str, arguments: Sequence[str], action: str, reason: str) -> None:
        self.module = module
        self.arguments = tuple(arguments)
        self.action = action
        super().__init__(
            f"attachment [{' '.join((module, *self.arguments))}] of action {action}: {reason}"
        )
