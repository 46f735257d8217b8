"""Which of the plans that a search has found a team takes while it explores.

What a plan promises there is uncertain, and what robots are on their way to is worth more than it
seems: a team that changes its mind whenever another order looks a little better drives to and fro.
"""

from collections.abc import Mapping, Sequence

import planner
from domains.formulation import Formulation, OrderKind
from domains.mission_state import MissionState
from domains.naming import Names

PROMPTNESS = 0.3
"""Weight of the mean time of visits beside the makespan: more targets will come than are known, and
robots that are done early are free for them."""
GAIN_S = 3.0
GAIN = 0.03
"""A plan that sends robots elsewhere than they are going has to be better by that much [s], and by
this share."""

Going = Mapping[str, str]
"""Where robots are going now, by id."""


def steadiest(
    plans: Sequence[planner.Plan], going: Going, formulation: Formulation, state: MissionState
) -> planner.Plan:
    """The last of some improving plans, or the best that lets every robot go where it is going.

    Args:
        plans: at least one, each better than the one before.
    """
    best, names = plans[-1], formulation.names(state)
    steady = next((p for p in reversed(plans) if _keeps(p, going, formulation, state)), best)
    if steady is best:
        return best
    kept_s, best_s = (worth_s(plan, formulation, names) for plan in (steady, best))
    return best if best_s < kept_s * (1.0 - GAIN) - GAIN_S else steady


def worth_s(plan: planner.Plan, formulation: Formulation, names: Names) -> float:
    """Makespan and mean time of the visits of a plan [s]; less is better."""
    visits_s = [
        step.end
        for step in plan
        for order in formulation.orders(step, names)
        if order.kind is OrderKind.EXPLORE
    ]
    return plan.makespan + PROMPTNESS * sum(visits_s) / max(len(visits_s), 1)


def _keeps(plan: planner.Plan, going: Going, formulation: Formulation, state: MissionState) -> bool:
    first = {
        assignment.robot: assignment.location
        for assignment in formulation.assignments(plan, state)
        if assignment.kind in (OrderKind.MOVE, OrderKind.EXPLORE)
    }
    return all(first.get(robot) == place for robot, place in going.items())
