"""Validates plans, independently of the search."""

from dataclasses import dataclass

from planner import _core
from planner.attachments import Attachments, as_dict, attachment_error
from planner.diagnostics import without_panics
from planner.plan import tuples_of
from planner.reading import DomainLike, PlanLike, ProblemLike, read_plan, read_problem


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a plan is valid; if not, the first thing that is wrong."""

    valid: bool
    makespan: float
    """End of the last step [s]."""
    metric: float | None
    """Value of the problem's metric; None for an invalid plan or a problem without metric."""
    reason: str | None
    """A stable word for what is wrong: condition, duration, interference, goal, ..."""
    message: str | None
    """The failure as text: happening, time, action, condition, facts around it."""
    time: float | None
    """When it fails [s]."""
    happening: int | None
    """Which happening fails, counted from 1."""
    step: int | None
    """Which step of the plan fails, counted from 0."""
    facts: tuple[str, ...]
    """The facts and values around the failure."""
    report: tuple[str, ...]
    """Every check and change in order of time, if asked for."""

    def __bool__(self) -> bool:
        return self.valid


def validate(
    domain: DomainLike,
    problem: ProblemLike,
    plan: PlanLike,
    *,
    attachments: Attachments | None = None,
    tolerance_s: float = 0.001,
    separation_s: float = 0.0,
    report: bool = False,
) -> Verdict:
    """Executes a plan on the problem as written and tells of the first thing that is wrong.

    `tolerance_s` is VAL's `-t`: durations may be off by as much, and what lies within a tenth of
    it happens at once. With `separation_s`, happenings that interfere must also be that far
    apart, to within a tenth of the tolerance. docs/validator.md tells the semantics.

    Raises `PddlError` for texts that cannot be read, `AttachmentError` for an attachment that is
    missing or fails.
    """
    parsed = read_problem(domain, problem)
    steps = read_plan(parsed, plan)
    with without_panics():
        verdict, exception = _core.validate(
            parsed, tuples_of(steps), as_dict(attachments), tolerance_s, separation_s, report
        )
    if verdict.attachment is not None:
        raise attachment_error(verdict.attachment, exception)
    return Verdict(
        verdict.valid,
        verdict.makespan,
        verdict.metric,
        verdict.reason,
        verdict.message,
        verdict.time,
        verdict.happening,
        verdict.step,
        tuple(verdict.facts),
        tuple(verdict.report),
    )
