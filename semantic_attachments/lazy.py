"""Planning with costs that are expensive to compute: bounds first, refined where plans use them.

A plan is sought with lower bounds; the costs of its actions are computed and replace their bounds;
that repeats until a plan holds with true costs only. A problem without plan under the bounds has
none.

Source: Dellin and Srinivasa, "A unifying formalism for shortest path problems with expensive edge
evaluations via lazy best-first search over paths with edge selectors", ICAPS 2016 (LazySP); here
plans take the place of paths.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from time import monotonic
from typing import ClassVar, Protocol

import planner

Call = tuple[str, ...]

_SEEKING = 0.6
"""Share of the time in which further costs are computed."""


class Refinable(Protocol):
    """A cost with a cheap lower bound."""

    def many(self, calls: Sequence[Call]) -> Sequence[float]:
        """True costs."""
        ...

    def lower_bounds(self, calls: Sequence[Call]) -> Sequence[float]:
        """Costs that the true ones are never below."""
        ...


class Optimistic:
    """An evaluator that answers with true costs where they are known and with bounds elsewhere."""

    purity = "arguments"
    quality = "lower bound"

    def __init__(self, attachment: Refinable) -> None:
        self.known: dict[Call, float] = {}
        """True costs."""
        self.asked: dict[Call, None] = {}
        """Calls since `asked` was cleared, in their order."""
        self._attachment = attachment
        self._bounds: dict[Call, float] = {}

    def __call__(self, *arguments: str) -> float:
        return self.many([arguments])[0]

    def many(self, calls: Sequence[Call]) -> list[float]:
        """What is known of many calls, in their order."""
        unknown = [c for c in calls if c not in self.known and c not in self._bounds]
        self._bounds.update(zip(unknown, self._attachment.lower_bounds(unknown), strict=True))
        self.asked.update(dict.fromkeys(calls))
        return [self.known[call] if call in self.known else self._bounds[call] for call in calls]

    def refine(self) -> bool:
        """Computes the costs of the calls asked; whether one is above its bound."""
        calls = [call for call in self.asked if call not in self.known]
        self.known.update(zip(calls, self._attachment.many(calls), strict=True))
        return any(self.known[call] > self._bounds[call] for call in calls)


@dataclass(frozen=True, slots=True)
class Known:
    """An evaluator of the costs that are known; without its cost an action cannot be."""

    quality: ClassVar[str] = "approximate"
    known: Mapping[Call, float]

    def __call__(self, *arguments: str) -> float:
        return self.known.get(arguments, inf)

    def many(self, calls: Sequence[Call]) -> list[float]:
        """Many at once."""
        return [self.known.get(tuple(call), inf) for call in calls]


@dataclass(frozen=True, slots=True)
class LazyResult:
    """How lazy planning ended."""

    result: planner.Result
    """That of the last round; its plan holds with true costs if `exact`."""
    exact: bool
    """Whether all costs of the plan are true ones, or there is certainly no plan."""
    rounds: int
    """Plans that were sought."""
    refined: int
    """Costs that were computed."""


def solve_lazily(
    domain: planner.Domain | str,
    problem: planner.Problem | str,
    lazy: Mapping[str, Refinable],
    *,
    attachments: planner.Attachments | None = None,
    timeout_s: float = 10.0,
    seed: int = 0,
) -> LazyResult:
    """Plans with `lazy` attachments refined where needed, and others as they are.

    A round seeks a plan for a twentieth of the time, twice as long after each round that finds
    none. What is left of the time after six tenths of it goes to the costs known by then: the last
    plan, and better ones that need no others. Raises what `planner.solve` raises.
    """
    begun = monotonic()
    parsed = planner.read_problem(domain, problem)
    optimistic = {name: Optimistic(attachment) for name, attachment in lazy.items()}
    bound = {**(attachments or {}), **optimistic}
    rounds, round_s = 0, timeout_s / 20
    plan: planner.Plan | None = None
    exact = False
    while True:
        rounds += 1
        result = planner.solve(
            domain, parsed, attachments=bound, timeout_s=round_s, seed=seed, warm_start=plan
        )
        plan = result.plan
        exact = result.outcome is planner.Outcome.PROVEN_UNSOLVABLE
        if plan is None:
            round_s *= 2
        else:
            for one in optimistic.values():
                one.asked.clear()
            # The validator asks for the costs of the plan's actions and no others.
            planner.validate(domain, parsed, plan, attachments=bound)
            above = [one.refine() for one in optimistic.values()]
            exact = not any(above)
        if exact or monotonic() >= begun + _SEEKING * timeout_s:
            break
    if not exact:
        rounds += 1
        settled = planner.solve(
            domain,
            parsed,
            attachments={**bound, **{name: Known(one.known) for name, one in optimistic.items()}},
            timeout_s=max(begun + timeout_s - monotonic(), round_s),
            seed=seed,
            warm_start=plan,
        )
        if settled.plan is not None:
            result, exact = settled, True
    refined = sum(len(one.known) for one in optimistic.values())
    return LazyResult(result, exact, rounds, refined)
