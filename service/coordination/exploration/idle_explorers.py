"""Robots that a plan does not need look for more to do, where there is more than is known."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from domains.formulation import Assignment, OrderKind
from domains.mission_state import Activity
from semantic_attachments.contract import Memory
from service.coordination.assignment import nearest_pairs
from service.coordination.exploration.strategy import CLEARER, problem_of
from service.coordination.strategy import Proposal, Situation, Strategy

DOMAIN = "disaster"
"""Carriers and rovers of the marsupial domain wait for one another: none of them is idle."""


@dataclass(frozen=True)
class IdleExplorers:
    """A strategy whose idle robots explore as well.

    A plan of the least makespan sends out as few robots as it takes to visit all targets. The
    targets of an exploration are only what is known of the work: behind them there is more.
    """

    strategy: Strategy

    @property
    def fallback(self) -> Strategy | None:
        """What is asked instead where the strategy is too much for a worker."""
        found: Strategy | None = getattr(self.strategy, "fallback", None)
        return found

    def propose(self, situation: Situation, memory: Memory) -> Proposal:
        """The strategy's proposal, in an exploration with orders for the robots without any."""
        proposal = self.strategy.propose(situation, memory)
        if not situation.exploring or situation.domain != DOMAIN:
            return proposal
        found = self._idle(proposal.assignments, situation, memory)
        if not found:
            return proposal
        driven = {order.robot for order in found}
        kept = [order for order in proposal.assignments if order.robot not in driven]
        return replace(
            proposal,
            assignments=(*kept, *found),
            reason=f"{proposal.reason}; {len(found)} more to the nearest frontiers",
        )

    @staticmethod
    def _idle(
        assignments: Sequence[Assignment], situation: Situation, memory: Memory
    ) -> list[Assignment]:
        """To the nearest target that nobody is on the way to; if there is none, to the nearest."""
        busy = {order.robot for order in assignments if order.kind is not OrderKind.WAIT}
        idle = [
            robot
            for robot in situation.state.robots
            if robot.type != CLEARER and robot.activity is Activity.FREE and robot.id not in busy
        ]
        targets = situation.state.targets
        if not idle or not targets:
            return []
        costs_s = problem_of(idle, situation, memory).costs_s
        taken = {order.location for order in assignments if order.robot in busy}
        untaken = [column for column, target in enumerate(targets) if target.id not in taken]
        columns = untaken or list(range(len(targets)))
        chosen = nearest_pairs(costs_s[:, columns].tolist(), share=True)
        return [
            Assignment(
                idle[row].id,
                OrderKind.EXPLORE,
                targets[columns[column]].id,
                expected_duration_s=float(costs_s[row, columns[column]]),
            )
            for row, column in sorted(chosen.items())
            if np.isfinite(costs_s[row, columns[column]])
        ]
