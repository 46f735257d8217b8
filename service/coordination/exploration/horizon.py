"""Which exploration targets carriers and rovers plan for: those that are near.

Behind every frontier there is more than is known. The best tour through all that is known leaves
rooms for the way back, and there is no way back as soon as the next corridor has been seen; a team
that plans for what is near finishes one place before it goes on to the next.
"""

from collections.abc import Collection
from math import isfinite

from domains.mission_state import Activity
from semantic_attachments.contract import Memory
from service.coordination.strategy import Situation
from service.coordination.travel import Travel, as_if_everywhere

NEAREST = 8
"""Targets that each carrier plans for."""


def within_horizon(
    situation: Situation, targets: Collection[str], memory: Memory
) -> frozenset[str]:
    """The targets nearest to each carrier, those that rovers on the ground get to, urgent ones.

    Near is what is soon reached by a carrier that could drive on all ground, as it takes its rovers
    close to what only they can enter. All targets, if that leaves none.
    """
    ordered = sorted(targets)
    urgent = situation.priorities.keys() | situation.deadlines_s.keys()
    chosen = {target for target in ordered if target in urgent}
    away = [
        robot
        for robot in situation.state.robots
        if robot.activity not in (Activity.FAILED, Activity.DOCKED)
    ]
    carriers = [robot.id for robot in away if situation.models[robot.type].capacity > 0]
    for times_s in as_if_everywhere(situation).times_s(carriers, ordered):
        near = sorted(zip(times_s, ordered, strict=True))[:NEAREST]
        chosen |= {target for time_s, target in near if isfinite(time_s)}
    rovers = [robot.id for robot in away if robot.id not in carriers]
    for times_s in Travel.of(situation, memory).times_s(rovers, ordered):
        chosen |= {t for time_s, t in zip(times_s, ordered, strict=True) if isfinite(time_s)}
    return frozenset(chosen or ordered)
