"""Path costs with people's word on top: infinite where a robot shall not go."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from semantic_attachments.contract import Evaluator


@dataclass(frozen=True)
class RestrictedCosts:
    """`pathCost` in which some robots and goals, by their PDDL names, do not go together."""

    costs: Evaluator
    avoid: frozenset[tuple[str, str]]

    def __call__(self, *arguments: str) -> float:
        return self.many([arguments])[0]

    def many(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
        """Travel times [s] of (robot, from, to); infinite for what is to be avoided."""
        return [
            inf if (call[0], call[-1]) in self.avoid else time_s
            for call, time_s in zip(calls, self.costs.many(calls), strict=True)
        ]
