"""Runs a function with a time limit, whatever it does.

Python cannot stop a thread, so a function that overruns goes on in a daemon thread that nobody
waits for; the next one gets a new thread. The planner's state may be read in its own thread only:
requests travel back to it.
"""

from collections.abc import Callable
from contextvars import copy_context
from queue import Empty, SimpleQueue
from threading import Thread, local
from time import monotonic
from typing import Any

from semantic_attachments.contract import EvaluationError, StateView


class TimeLimit:
    """Runs functions in a thread that belongs to the caller's; without limit, in the caller's
    own."""

    def __init__(self, seconds: float | None) -> None:
        self.seconds = seconds
        self._workers = local()

    def run(
        self,
        function: Callable[..., Any],
        arguments: tuple[Any, ...],
        state: StateView | None,
        *,
        state_first: bool,
        last_progress_s: Callable[[], float] | None = None,
    ) -> Any:
        """What the function returns or raises.

        Args:
            last_progress_s: monotonic time from which the limit counts, if it does more than one
            thing that the limit holds for.

        Raises:
            EvaluationError: if it takes longer than the limit.
        """
        if self.seconds is None:
            return function(*_with_state(arguments, state, state_first))
        worker = getattr(self._workers, "worker", None) or Worker()
        self._workers.worker = worker
        answers: SimpleQueue[tuple[str, Any]] = SimpleQueue()
        served = None if state is None else ServedState(answers)
        worker.tasks.put(
            (copy_context(), function, _with_state(arguments, served, state_first), answers)
        )
        deadline = monotonic() + self.seconds
        while True:
            try:
                kind, content = answers.get(timeout=max(deadline - monotonic(), 0.0))
            except Empty:
                if last_progress_s is not None:
                    deadline = last_progress_s() + self.seconds
                    if deadline > monotonic():
                        continue
                del self._workers.worker
                raise EvaluationError(f"it took longer than {self.seconds:g} s") from None
            if kind == "returned":
                return content
            if kind == "raised":
                raise content
            question, reply = content
            reply.put(_answer(question, state))


class Worker:
    """A daemon thread that runs tasks until nobody refers to it any more."""

    def __init__(self) -> None:
        self.tasks: SimpleQueue[Any] = SimpleQueue()
        Thread(target=_work, args=(self.tasks,), daemon=True, name="attachment").start()

    def __del__(self) -> None:
        self.tasks.put(None)


class ServedState:
    """A state that asks the thread it belongs to."""

    def __init__(self, answers: SimpleQueue[tuple[str, Any]]) -> None:
        self._answers = answers

    def holds(self, predicate: str, *arguments: str) -> bool:
        """Whether a fact holds."""
        return bool(self._ask("holds", predicate, arguments))

    def value(self, function: str, *arguments: str) -> float | None:
        """The value of a numeric fluent, None where it is undefined."""
        found = self._ask("value", function, arguments)
        return None if found is None else float(found)

    def _ask(self, method: str, symbol: str, arguments: tuple[str, ...]) -> Any:
        reply: SimpleQueue[tuple[bool, Any]] = SimpleQueue()
        self._answers.put(("asked", ((method, symbol, arguments), reply)))
        succeeded, content = reply.get()
        if not succeeded:
            raise content
        return content


def _with_state(
    arguments: tuple[Any, ...], state: StateView | None, state_first: bool
) -> tuple[Any, ...]:
    if state is None:
        return arguments
    return (state, *arguments) if state_first else (*arguments, state)


def _answer(question: tuple[str, str, tuple[str, ...]], state: Any) -> tuple[bool, Any]:
    method, symbol, arguments = question
    try:
        return True, getattr(state, method)(symbol, *arguments)
    except Exception as error:
        return False, error


def _work(tasks: SimpleQueue[Any]) -> None:
    while (task := tasks.get()) is not None:
        context, function, arguments, answers = task
        try:
            answers.put(("returned", context.run(function, *arguments)))
        except BaseException as error:
            answers.put(("raised", error))
        # An idle thread must not keep the last world alive.
        del task, context, function, arguments, answers
