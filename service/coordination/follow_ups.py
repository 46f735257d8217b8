"""What robots do after their orders while nobody can tell them anything else."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from domains.formulation import Assignment, Formulation, OrderKind
from domains.naming import Names
from planner import Plan
from service.coordination.strategy import Situation


def follow_ups(
    situation: Situation,
    formulation: Formulation,
    plan: Plan,
    assignments: Sequence[Assignment],
    names: Names | None = None,
) -> Mapping[str, tuple[Assignment, ...]]:
    """The further steps of a plan by robot, and clearers that clear what they are sent to.

    Args:
        names: the plan's, if it is an older one.
    """
    if situation.commands_ahead == 0:
        return {}
    planned = formulation.following(plan, situation.state, names)
    return {**clear_on_arrival(situation, assignments), **{r: a for r, a in planned.items() if a}}


def clear_on_arrival(
    situation: Situation, assignments: Sequence[Assignment]
) -> Mapping[str, tuple[Assignment, ...]]:
    """Clearers that have driven to a blockade clear it."""
    if situation.commands_ahead == 0:
        return {}
    clearers = {robot.id for robot in situation.state.robots if robot.type == "clearer"}
    durations_s = {b.id: b.clear_duration_s for b in situation.state.blockades}
    return {
        order.robot: (
            replace(
                order, kind=OrderKind.CLEAR, expected_duration_s=durations_s[order.location or ""]
            ),
        )
        for order in assignments
        if order.robot in clearers
        and order.kind is OrderKind.MOVE
        and (order.location or "") in durations_s
    }
