"""One decision: the strategy's proposal and the paths of its orders, and how long it may take."""

from collections.abc import Mapping
from dataclasses import dataclass

from semantic_attachments.contract import Memory
from service.coordination import dispatch
from service.coordination.strategy import Proposal, Situation, Strategy
from service.messages.mission import PlanningMessage


@dataclass(frozen=True)
class Decided:
    """A proposal and the orders that come of it."""

    proposal: Proposal
    orders: Mapping[str, dispatch.Order]


@dataclass(frozen=True)
class Deliberation:
    """What runs away from the event loop: the strategy, then the paths of its orders."""

    strategy: Strategy
    memory: Memory

    def __call__(self, snapshot: Situation) -> Decided:
        proposal = self.strategy.propose(snapshot, self.memory)
        return Decided(proposal, dispatch.orders(proposal, snapshot, self.memory))


LEAST_TIME_LIMIT_S = 0.05
"""Below this a replan finds too little to be worth its formulation."""


def within_load(planning: PlanningMessage, load: float) -> PlanningMessage:
    """The effort of a replan when others wait for theirs: the time is shared.

    A mission with a node limit is to be repeatable and keeps its effort.
    """
    if planning.node_limit is not None or load < 1.0:
        return planning
    shared_s = max(LEAST_TIME_LIMIT_S, planning.time_limit_s / (1.0 + load))
    return planning.model_copy(update={"time_limit_s": min(planning.time_limit_s, shared_s)})
