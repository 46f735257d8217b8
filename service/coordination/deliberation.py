"""One decision: the strategy's proposal and the paths of its orders, computed in a worker."""

import logging
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

from semantic_attachments.contract import Memory
from service.coordination import dispatch
from service.coordination.strategy import NoPlanError, Proposal, Situation, Strategy
from service.jobs.executor import Tell

LOG = logging.getLogger(__name__)
SEARCHES = 3
"""A decision plans for everything, for what is urgent and for the rest, at most."""


@dataclass(frozen=True)
class Decided:
    """A proposal and the orders that come of it."""

    proposal: Proposal
    orders: Mapping[str, dispatch.Order]
    proposing_s: float = 0.0
    """Time that the strategy took [s]."""
    routing_s: float = 0.0
    """Time that the paths of the orders took [s]."""


@dataclass(frozen=True)
class Deliberation:
    """What runs away from the event loop: the strategy, then the paths of its orders."""

    mission_id: str
    fleet: str
    strategy: Strategy
    situation: Situation
    traceparent: str | None = None
    """The span that asks for it."""
    overhead_limit_s: float = 60.0
    """Time that a decision may take beside its searches before it is stopped by force [s]."""

    @property
    def affinity(self) -> str:
        """A mission's decisions share what its attachments keep."""
        return self.mission_id

    @property
    def hard_limit_s(self) -> float:
        """Wall-clock time after which its worker is killed."""
        return SEARCHES * self.situation.planning.time_limit_s + self.overhead_limit_s

    def decide(self, memory: Memory) -> Decided:
        """Raises NoPlanError where there is nothing that the team can do."""
        begun_s = time.perf_counter()
        proposal = self.strategy.propose(self.situation, memory)
        proposed_s = time.perf_counter()
        orders = dispatch.orders(proposal, self.situation, memory)
        return Decided(
            proposal, orders, proposed_s - begun_s, routing_s=time.perf_counter() - proposed_s
        )

    def answer(self, tell: Tell, memory: Memory) -> None:
        """Decides, and tells what was decided."""
        try:
            decided = self.decide(memory)
        except NoPlanError as error:
            tell({"kind": "failed", "outcome": "no_plan", "message": str(error)})
        except Exception as error:
            LOG.exception("mission %s: the strategy failed", self.mission_id)
            tell({"kind": "failed", "outcome": "faulty", "message": str(error)})
        else:
            tell({"kind": "finished", "decided": decided})

    def simpler(self) -> "Deliberation":
        """What to decide where this was too much for a worker."""
        fallback = getattr(self.strategy, "fallback", None)
        return self if fallback is None else replace(self, strategy=fallback)


LEAST_TIME_LIMIT_S = 0.05
"""Below this a replan finds too little to be worth its formulation."""


def shared(situation: Situation, share_s: float) -> Situation:
    """A decision's effort where many missions want theirs.

    A mission with a node limit is to be repeatable and keeps its effort.

    Args:
        share_s: time for each decision.
    """
    planning = situation.planning
    if planning.node_limit is not None or planning.time_limit_s <= share_s:
        return situation
    limit_s = min(planning.time_limit_s, max(LEAST_TIME_LIMIT_S, share_s))
    return replace(
        situation, hurried=True, planning=planning.model_copy(update={"time_limit_s": limit_s})
    )
