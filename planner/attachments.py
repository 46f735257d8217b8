"""What the planner takes as an attachment (a PDDL/M module): a callable, or an object that
answers in batches.

Source: Dornhege et al., "Semantic attachments for domain-independent planning systems", ICAPS 2009.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, TypeAlias, runtime_checkable

from planner import _core
from planner.diagnostics import AttachmentError, PlannerError


@runtime_checkable
class BatchAttachment(Protocol):
    """Answers many calls at once; the planner prefers it to single calls.

    With an attribute `purity` other than "arguments", the value depends on the state: the
    planner then calls `many(calls, state)` and keeps no value. `state.holds("at", "e1", "a")`
    and `state.value("energy", "e1")` read it.
    """

    def many(self, calls: Sequence[tuple[str, ...]]) -> Sequence[float]:
        """Costs [s] or truth values, one a call."""
        ...


Attachment: TypeAlias = Callable[..., Any] | BatchAttachment
"""`f(*argument_names) -> float` for costs and condition checkers, `f(state, *argument_names)`
returning the new values of the fluents written, or None, for effects; or a `BatchAttachment`.
"""

Attachments: TypeAlias = Mapping[str, Attachment]
"""Attachments by the name of their module; case does not matter."""


def attachment_error(
    failed: tuple[str, list[str], str], reason: str, cause: BaseException | None
) -> PlannerError:
    """The error for a failed call. Interrupts and exits raised by an attachment go through as
    they are.
    """
    if cause is not None and not isinstance(cause, Exception):
        raise cause
    module, arguments, action = failed
    error = AttachmentError(module, arguments, action, reason)
    error.__cause__ = cause
    return error


def as_dict(attachments: Attachments | None) -> dict[str, Attachment]:
    """A plain dictionary, as the border takes it."""
    return dict(attachments or {})


State = _core.State
