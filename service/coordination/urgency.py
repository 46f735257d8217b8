"""Priorities and deadlines: which targets come first, and how late a set of visits would be.

A deadline ranks above every priority; of the priorities the highest counts, and the next one once
its targets are visited.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import inf

from service.coordination.assignment import AssignmentRule
from service.coordination.strategy import Situation
from service.coordination.travel import Travel

NEVER_S = 1e6
"""Lateness of a target that is not visited at all, so that sums can be compared [s]."""


def urgent(situation: Situation, targets: Collection[str]) -> tuple[list[str], list[str]]:
    """Targets with deadlines, the earliest first, and those of the highest priority beside them."""
    deadlines = {t: s for t, s in situation.deadlines_s.items() if t in targets}
    priorities = {
        t: p for t, p in situation.priorities.items() if t in targets and t not in deadlines
    }
    highest = max(priorities.values(), default=0)
    first = sorted(deadlines, key=lambda target: (deadlines[target], target))
    return first, sorted(target for target, p in priorities.items() if p == highest)


def tiers(situation: Situation, targets: Collection[str]) -> list[list[str]]:
    """Targets by urgency: deadlines, highest priority, the rest; no tier is empty."""
    first, second = urgent(situation, targets)
    rest = [target for target in targets if target not in {*first, *second}]
    return [tier for tier in (first, second, rest) if tier]


def is_urgent(situation: Situation, targets: Collection[str]) -> bool:
    """Whether any of the targets has a deadline or a priority."""
    return any(t in situation.deadlines_s or t in situation.priorities for t in targets)


@dataclass(frozen=True, order=True, slots=True)
class Lateness:
    """How badly visits obey; the less, the better."""

    deadlines_missed: int
    deadline_s: float
    """Sum of what deadlines are missed by."""
    priority_s: float
    """Sum of what targets of the highest priority come later than they could."""


def lateness(
    visits_s: Mapping[str, float], deadlines_s: Mapping[str, float], soonest_s: Mapping[str, float]
) -> Lateness:
    """How badly visits, in seconds from now, obey deadlines and soonest times, also from now."""
    late = [
        min(visits_s.get(target, inf) - time_s, NEVER_S)
        for target, time_s in deadlines_s.items()
        if visits_s.get(target, inf) > time_s
    ]
    after = [
        min(visits_s.get(target, inf) - time_s, NEVER_S)
        for target, time_s in soonest_s.items()
        if visits_s.get(target, inf) > time_s
    ]
    return Lateness(len(late), sum(late), sum(after))


def assigned_by_urgency(
    rule: AssignmentRule,
    situation: Situation,
    travel: Travel,
    robots: Sequence[str],
    targets: Sequence[str],
    *,
    share: bool = False,
) -> dict[int, int]:
    """Column of each row, where urgent targets get their robots before others do.

    Args:
        share: robots that are left over go to targets that somebody goes to already.
    """
    if not is_urgent(situation, targets):
        return rule(travel, robots, targets, share=share)
    chosen: dict[int, int] = {}
    for tier in tiers(situation, targets):
        rows = [row for row in range(len(robots)) if row not in chosen]
        if rows:
            found = rule(travel, [robots[row] for row in rows], tier)
            chosen |= {rows[row]: targets.index(tier[column]) for row, column in found.items()}
    left = [row for row in range(len(robots)) if row not in chosen]
    if share and left:
        found = rule(travel, [robots[row] for row in left], targets, share=True)
        chosen |= {left[row]: column for row, column in found.items()}
    return chosen
