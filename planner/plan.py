"""Time-triggered plans."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Self, TypeAlias, overload

from planner import _core
from planner._core import Problem
from planner.diagnostics import PddlError, without_panics

StepTuple: TypeAlias = tuple[float, str, list[str], float | None]
"""A step at the border: start [s], action, arguments, duration [s]."""
DUST_S = 1e-10
"""Least distance from a whole nanosecond that is no error of floating point [s]."""


@dataclass(frozen=True, slots=True)
class Step:
    """An action with its start and duration."""

    start: float
    """Start [s]."""
    action: str
    """Name of the action."""
    arguments: tuple[str, ...]
    """Names of the objects it is applied to."""
    duration: float | None
    """Duration [s]; None for an instantaneous action."""

    @property
    def end(self) -> float:
        """End [s]."""
        return self.start + (self.duration or 0.0)

    def __str__(self) -> str:
        return f"({' '.join((self.action, *self.arguments))})"


@dataclass(frozen=True, slots=True)
class Plan(Sequence[Step]):
    """Steps sorted by start, and what is known of how they were found.

    Two plans are equal if their steps are.
    """

    steps: tuple[Step, ...]
    domain: str | None = None
    """The domain's name."""
    problem: str | None = None
    """The problem's name."""
    metric: float | None = None
    """The value of the problem's metric, where it has one."""
    evaluated: int | None = None
    """States evaluated until it was found."""
    cpu_s: float | None = None
    """CPU time of this process, counted from its start, when it was found [s]."""
    wall_s: float | None = None
    """Time since `solve` was called when it was found [s]."""

    @classmethod
    def from_text(cls, text: str | bytes, problem: Problem, name: str = "plan") -> Self:
        """Reads plan text; see `to_text` for the format, docs/validator.md for accepted variants.

        Raises `PddlError` with every fault: unknown names, wrong arguments, missing durations.
        """
        content = text.encode() if isinstance(text, str) else text
        with without_panics():
            steps, diagnostics = _core.read_plan(problem, content, name)
        if steps is None:
            raise PddlError(diagnostics)
        return cls(steps_of(steps), problem.domain.name, problem.name)

    def to_text(self) -> str:
        """`5.001: (launch d1 c1 b) [2.000]`, a line a step; numbers read back as the same
        numbers.
        """
        return _core.write_plan(
            tuples_of(self),
            domain=self.domain,
            problem=self.problem,
            evaluated=self.evaluated,
            metric=self.metric,
        )

    def to_json(self) -> dict[str, Any]:
        """The plan as `marsupial plan --json` writes it."""
        return {
            "makespan": self.makespan,
            "metric": self.metric,
            "cpu_s": self.cpu_s,
            "wall_s": self.wall_s,
            "steps": [
                {
                    "start": step.start,
                    "action": step.action,
                    "args": list(step.arguments),
                    "duration": step.duration,
                }
                for step in self.steps
            ],
        }

    @property
    def makespan(self) -> float:
        """The end of the last step [s], without what adding start and duration leaves behind."""
        end_s = max((step.end for step in self.steps), default=0.0)
        nearest_s = round(end_s, 9)
        return nearest_s if abs(nearest_s - end_s) < DUST_S else end_s

    def __len__(self) -> int:
        return len(self.steps)

    def __iter__(self) -> Iterator[Step]:
        return iter(self.steps)

    @overload
    def __getitem__(self, index: int) -> Step: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Step, ...]: ...
    def __getitem__(self, index: int | slice) -> Step | tuple[Step, ...]:
        return self.steps[index]

    def __eq__(self, other: object) -> bool:
        return self.steps == other.steps if isinstance(other, Plan) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.steps)

    def __str__(self) -> str:
        return self.to_text()


def steps_of(tuples: Sequence[StepTuple]) -> tuple[Step, ...]:
    """Steps from what the border gives."""
    return tuple(
        Step(start, action, tuple(arguments), duration)
        for start, action, arguments, duration in tuples
    )


def tuples_of(steps: Sequence[Step]) -> list[StepTuple]:
    """Steps as the border takes them."""
    return [(step.start, step.action, list(step.arguments), step.duration) for step in steps]
