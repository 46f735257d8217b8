"""A guard around every bound attachment: whatever it does, the planner gets checked values or an
error.

Faults of attachments (exceptions, NaN, negative costs, wrong types and counts, overrun of a time
limit, asking itself through the planner, reading what it did not declare) become `EvaluationError`.
What it is given it cannot change.
"""

from collections.abc import Callable, Sequence
from contextvars import ContextVar
from math import isnan
from numbers import Real
from threading import RLock, Semaphore
from time import monotonic
from typing import Any

import numpy as np

from semantic_attachments.contract import Attachment, EvaluationError, Kind, Purity, StateView
from semantic_attachments.time_limit import TimeLimit

Call = tuple[str, ...]

_MEMO_LIMIT = 500_000
"""Values remembered by one attachment before it starts anew."""

_LOCK_LIMIT_S = 60.0
"""How long a thread waits for an attachment that is busy and has no time limit [s]."""

_MOST_ASKERS = 64
"""Threads that may ask one attachment at once; more are one that asks itself again and again."""

_underway: ContextVar[tuple[int, ...]] = ContextVar("underway", default=())
"""The guards whose attachments are being evaluated, outermost first."""


class Guarded:
    """A bound attachment as the planner asks it; `purity` tells the planner whether to pass the
    state, `quality` what it can prove with the values."""

    def __init__(
        self, attachment: Attachment, function: Callable[..., Any], time_limit_s: float | None
    ) -> None:
        self.attachment = attachment
        self.purity = str(attachment.purity)
        self.quality = str(attachment.quality)
        self._function = function
        self._limit = TimeLimit(None if attachment.quick else time_limit_s)
        self._lock = RLock()
        self._askers = Semaphore(_MOST_ASKERS)
        self._memo: dict[tuple[Any, ...], float] = {}

    @property
    def inner(self) -> Callable[..., Any]:
        """The attachment itself, without guard."""
        return self._function

    def __call__(self, *arguments: Any) -> Any:
        """The single form; effects and impure attachments take the state first."""
        if self.attachment.kind is Kind.EFFECT:
            return self._effect(arguments[0], arguments[1:])
        if self.attachment.purity is Purity.ARGUMENTS:
            return self.many([arguments])[0]
        return self.many([arguments[1:]], arguments[0])[0]

    def many(self, calls: Sequence[Call], state: StateView | None = None) -> list[float]:
        """The batch form.

        Raises:
            EvaluationError: with the position of the call that failed, as far as that is known.
        """
        calls = tuple(tuple(call) for call in calls)
        self._check_counts(calls)
        if self.attachment.purity is Purity.FLUENTS:
            return [self._remembered(call, state, i) for i, call in enumerate(calls)]
        return self._values(calls, state)

    def _remembered(self, call: Call, state: StateView | None, position: int) -> float:
        if state is None:
            raise EvaluationError(f"{self.attachment.name} needs a state", position)
        declared = DeclaredState(self.attachment, call, state)
        key = (call, declared.values())
        if key not in self._memo:
            if len(self._memo) >= _MEMO_LIMIT:
                self._memo.clear()
            try:
                self._memo[key] = self._values((call,), declared)[0]
            except EvaluationError as error:
                error.position = position
                raise
        return self._memo[key]

    def _values(self, calls: tuple[Call, ...], state: StateView | None) -> list[float]:
        many = getattr(self._function, "many", None)
        if many is None:
            return self._singles(calls, state)
        found = self._run(many, (calls,), state, state_first=False)
        try:
            values = list(found)
        except TypeError:
            raise EvaluationError(f"many() returned {_shown(found)}, no sequence") from None
        if len(values) != len(calls):
            raise EvaluationError(f"many() returned {len(values)} values for {len(calls)} calls")
        return self._checked(values)

    def _singles(self, calls: tuple[Call, ...], state: StateView | None) -> list[float]:
        """The single form for each call; the time limit holds for each, the thread is one."""
        found: list[Any] = []
        progress_s = [monotonic()]
        failure: EvaluationError | None = None

        def each(given: tuple[Call, ...], view: StateView | None = None) -> None:
            for call in given:
                if failure is not None:  # given up
                    return
                found.append(self._function(*(call if view is None else (view, *call))))
                progress_s[0] = monotonic()

        try:
            self._run(each, (calls,), state, state_first=False, progress_s=progress_s)
        except EvaluationError as error:
            failure = error
        values = self._checked(tuple(found))
        if failure is not None:
            failure.position = min(len(values), len(calls) - 1)
            raise failure
        return values

    def _effect(self, state: StateView, call: Call) -> list[float] | None:
        self._check_counts((call,))
        found = self._run(self._function, call, state, state_first=True)
        if found is None:
            return None
        try:
            values = list(found)
        except TypeError:
            raise EvaluationError(f"it returned {_shown(found)}, no sequence of values") from None
        for value in values:
            if not _is_number(value) or isnan(value):
                raise EvaluationError(f"it returned {_shown(value)} as the value of a fluent")
        return [float(value) for value in values]

    def _run(
        self,
        function: Callable[..., Any],
        arguments: tuple[Any, ...],
        state: StateView | None,
        *,
        state_first: bool,
        progress_s: Sequence[float] = (),
    ) -> Any:
        underway = _underway.get()
        if id(self) in underway or not self._askers.acquire(blocking=False):
            raise EvaluationError("it asks itself through the planner, which would never end")
        token = _underway.set((*underway, id(self)))
        waiting_s = _LOCK_LIMIT_S if self._limit.seconds is None else self._limit.seconds
        shared = self.attachment.thread_safe
        if not shared and not self._lock.acquire(timeout=waiting_s):
            self._askers.release()
            _underway.reset(token)
            raise EvaluationError(f"it is still busy after {waiting_s:g} s")
        try:
            return self._limit.run(
                function,
                arguments,
                state,
                state_first=state_first,
                last_progress_s=(lambda: progress_s[0]) if progress_s else None,
            )
        except EvaluationError:
            raise
        except Exception as error:
            raise EvaluationError(f"it raised {type(error).__name__}: {error}") from error
        finally:
            self._askers.release()
            if not shared:
                self._lock.release()
            _underway.reset(token)

    def _check_counts(self, calls: Sequence[Call]) -> None:
        expected = len(self.attachment.parameters)
        for position, call in enumerate(calls):
            if len(call) != expected:
                raise EvaluationError(f"it takes {expected} arguments, not {len(call)}", position)

    def _checked(self, values: Sequence[Any]) -> list[float]:
        if self.attachment.kind is Kind.COST:
            # Nearly all are plain numbers of the right sign, thousands a decision.
            return [
                value if type(value) is float and value >= 0.0 else self._check(value, position)
                for position, value in enumerate(values)
            ]
        return [self._check(value, position) for position, value in enumerate(values)]

    def _check(self, value: Any, position: int) -> float:
        if self.attachment.kind is Kind.CONDITION:
            if not isinstance(value, bool | np.bool_):
                raise EvaluationError(
                    f"it returned {_shown(value)}; a condition is a bool", position
                )
            return float(value)
        if not _is_number(value):
            raise EvaluationError(f"it returned {_shown(value)}; a cost is a number", position)
        number = float(value)
        if isnan(number):
            raise EvaluationError(
                "it returned NaN; return inf where the action cannot be", position
            )
        if number < 0:
            raise EvaluationError(f"it returned {number:g}; a cost is never negative", position)
        return number


class DeclaredState:
    """A state that shows only what an attachment declares to read."""

    def __init__(self, attachment: Attachment, call: Call, state: StateView) -> None:
        names = {p.name: argument for p, argument in zip(attachment.parameters, call, strict=True)}
        self._declared = tuple(
            (symbol, *(names[parameter] for parameter in parameters))
            for symbol, *parameters in attachment.reads
        )
        self._name = attachment.name
        self._state = state

    def values(self) -> tuple[float | bool | None, ...]:
        """The values of all that is declared."""
        return tuple(self._read(*symbol) for symbol in self._declared)

    def holds(self, predicate: str, *arguments: str) -> bool:
        """Whether a declared fact holds."""
        self._check(predicate, *arguments)
        return self._state.holds(predicate, *arguments)

    def value(self, function: str, *arguments: str) -> float | None:
        """The value of a declared fluent."""
        self._check(function, *arguments)
        return self._state.value(function, *arguments)

    def _read(self, symbol: str, *arguments: str) -> float | bool | None:
        try:
            return self._state.value(symbol, *arguments)
        except KeyError:
            return self._state.holds(symbol, *arguments)

    def _check(self, *symbol: str) -> None:
        if symbol not in self._declared:
            raise EvaluationError(f"it reads ({' '.join(symbol)}), which its `reads` does not name")


def _is_number(value: Any) -> bool:
    return isinstance(value, Real | np.floating | np.integer) and not isinstance(value, bool)


def _shown(value: Any) -> str:
    return f"{str(value)[:40]!r} of type {type(value).__name__}"
