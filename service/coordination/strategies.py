"""All strategies by the name that a mission asks for."""

from collections.abc import Mapping
from dataclasses import dataclass

from semantic_attachments.contract import Memory
from service.coordination.assignment import by_nearest_pair
from service.coordination.auction import auction
from service.coordination.exploration.greedy_utility import GreedyUtility
from service.coordination.exploration.idle_explorers import IdleExplorers
from service.coordination.exploration.segment_assignment import SegmentAssignment
from service.coordination.exploration.strategy import Exploring
from service.coordination.greedy_clearing import GreedyClearing
from service.coordination.one_step_disaster import OneStepDisaster
from service.coordination.one_step_marsupial import OneStepMarsupial
from service.coordination.strategy import NoPlanError, Proposal, Situation, Strategy
from service.coordination.temporal import TemporalPlanning


def all_strategies() -> Mapping[str, Strategy]:
    """Every strategy; a new one is a file and a line here."""
    hungarian = ByDomain({"disaster": OneStepDisaster(), "marsupial": OneStepMarsupial()})
    temporal = TemporalPlanning(fallback=hungarian)
    return {
        "auction": ByDomain(
            {"disaster": OneStepDisaster(auction), "marsupial": OneStepMarsupial(auction)}
        ),
        "greedy": Exploring(GreedyUtility(), "greedy utility"),
        "greedy-clearing": ByDomain({"disaster": GreedyClearing(temporal)}),
        "hungarian": hungarian,
        "hungarian-literal": ByDomain(
            {
                "disaster": OneStepDisaster(waits_at_blockades=False),
                "marsupial": OneStepMarsupial(leaves_to_rovers=False),
            }
        ),
        "nearest": ByDomain(
            {
                "disaster": OneStepDisaster(by_nearest_pair),
                "marsupial": OneStepMarsupial(by_nearest_pair),
            }
        ),
        "planner": IdleExplorers(temporal),
        "segments": Exploring(SegmentAssignment(), "by segments of the map"),
    }


@dataclass(frozen=True)
class ByDomain:
    """A strategy that is another one in each domain."""

    variants: Mapping[str, Strategy]

    def propose(self, situation: Situation, memory: Memory) -> Proposal:
        """The proposal of the domain's variant."""
        variant = self.variants.get(situation.domain)
        if variant is None:
            raise NoPlanError(
                f"this strategy is not made for the domain {situation.domain}, "
                f"only for {', '.join(sorted(self.variants))}"
            )
        return variant.propose(situation, memory)


def serves(strategy: Strategy, domain: str) -> bool:
    """Whether a strategy is made for a domain."""
    return not isinstance(strategy, ByDomain) or domain in strategy.variants
