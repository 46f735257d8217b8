"""What the planner takes as an attachment (a PDDL/M module): a callable, or an object that
answers in batches.

Source: Dornhege et al., "Semantic attachments for domain-independent planning systems", ICAPS 2009.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, TypeAlias, runtime_checkable

from planner import _core
from planner.diagnostics import AttachmentError


@runtime_checkable
class BatchAttachment(Protocol):
    """Answers many calls at once; the planner prefers it to single calls.

    With an attribute `purity` other than "arguments", the value depends on the state: the
    planner then calls `many(calls, state)` and keeps no value. `state.holds("at", "e1", "a")`
    and `state.value("energy", "e1")` read it. An attribute `quality` limits what a search can
    prove with the values (`planner.proofs`).
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


FailedCall: TypeAlias = tuple[str, list[str], str, str]
"""A failed call at the border: module, arguments, action, reason."""


def attachment_error(failed: FailedCall, cause: BaseException | None) -> AttachmentError:
    """The error for a failed call.

    Interrupts and exits raised by an attachment go through as they are.
    """
    if cause is not None and not isinstance(cause, Exception):
        raise cause
    error = AttachmentError(*failed)
    error.__cause__ = cause
    return error


def as_dict(attachments: Attachments | None) -> dict[str, Attachment]:
    """A plain dictionary, as the border takes it."""
    return dict(attachments or {})


State = _core.State
