"""Optimised routes with greedy clearing: tells what routing gives from what coordination gives.

Explorers follow a plan over the targets that they can reach as the blockades stand; clearers go to
the nearest blockades and know nothing of that plan. Beside the temporal planner on one side and the
one-step baseline on the other, this arm shows how much of the planner's gain is plain routing.
"""

from dataclasses import dataclass, replace

from domains.mission_state import Activity
from semantic_attachments.contract import Memory
from service.coordination.assignment import by_hungarian_method
from service.coordination.one_step_disaster import (
    being_cleared,
    clear_nearest,
    free,
    wait_at_blockades,
)
from service.coordination.strategy import NoPlanError, Proposal, Situation, Strategy
from service.coordination.travel import Travel


@dataclass(frozen=True)
class GreedyClearing:
    """Plans for the explorers alone; clearers by assignment (disaster recovery)."""

    routing: Strategy
    """plans the explorers' routes"""

    def propose(self, situation: Situation, memory: Memory) -> Proposal:
        """A plan for the explorers, then an order for each clearer."""
        clearers = free(situation, "clearer")
        travel = Travel.of(situation, memory)
        clearing = clear_nearest(
            situation, travel, clearers, being_cleared(situation), by_hungarian_method
        )
        state = situation.state
        explorers_only = replace(
            situation,
            state=replace(
                state,
                robots=tuple(
                    replace(robot, activity=Activity.FAILED) if robot.type == "clearer" else robot
                    for robot in state.robots
                ),
            ),
        )
        try:
            routes = self.routing.propose(explorers_only, memory)
        except NoPlanError as error:
            routes = Proposal(assignments=(), reason=str(error))
        driving = {assignment.robot for assignment in routes.assignments}
        idle = [robot for robot in free(situation, "explorer") if robot not in driving]
        sealed = sorted(routes.unreachable) if routes.assignments else [t.id for t in state.targets]
        waiting = wait_at_blockades(situation, travel, idle, sealed, memory)
        at_work = any(robot.activity is Activity.CLEARING for robot in state.robots)
        if not (routes.assignments or waiting or clearing or at_work):
            raise NoPlanError("no robot can reach a target or a blockade")
        return replace(
            routes,
            assignments=(*routes.assignments, *waiting, *clearing),
            reason=f"{routes.reason}; {len(clearing)} clearers to the nearest blockades",
            unreachable=frozenset(),
            # To the routing clearers take no part.
            remarks={
                identifier: routes.remarks[identifier]
                for identifier, instruction in situation.instructions
                if identifier in routes.remarks
                and getattr(instruction, "robot", None) not in clearers
            },
        )
