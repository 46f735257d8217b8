"""Sequential single-item auctions (Lagoudakis et al., "Auction-Based Multi-Robot Routing", 2005).

In every round each robot bids, for each target nobody has yet, the time at which it would be done
with all its targets if it took that one in as well where it fits best (bidding rule MiniMax for
paths, cheapest insertion); the lowest bid wins. Only the first target of each robot's path is
ordered: the auction is held anew at every event, like every other strategy's decision.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import inf, isfinite

from service.coordination.travel import Travel


def auction(
    travel: Travel, robots: Sequence[str], goals: Sequence[str], *, share: bool = False
) -> dict[int, int]:
    """Index of each robot's first goal; a robot that wins nothing it can reach is not in it.

    Args:
        share: robots that win nothing go to the goal that is nearest to them, whoever has it.
    """
    starts_s = travel.times_s(robots, goals)
    between_s = {
        robot: [travel.times_between_s(robot, goals, goal) for goal in goals] for robot in robots
    }
    bidders = [
        _Bidder(starts_s[row], between_s[robot], len(goals)) for row, robot in enumerate(robots)
    ]
    left = set(range(len(goals)))
    while left:
        bid_s, winner, goal = min(
            (bidder.bids_s[goal], row, goal) for row, bidder in enumerate(bidders) for goal in left
        )
        if not isfinite(bid_s):
            break
        bidders[winner].take(goal)
        left.discard(goal)
    first = {row: bidder.path[0] for row, bidder in enumerate(bidders) if bidder.path}
    if share:
        for row in range(len(robots)):
            nearest = min(range(len(goals)), key=starts_s[row].__getitem__)
            if row not in first and isfinite(starts_s[row][nearest]):
                first[row] = nearest
    return first


@dataclass
class _Bidder:
    """A robot's path through the goals it has won."""

    start_s: Sequence[float]
    """from where it is to each goal"""
    between_s: Sequence[Sequence[float]]
    """[goal][from]"""
    goals: int
    path: list[int] = field(default_factory=list)
    bids_s: list[float] = field(init=False)
    """for each goal, how long the path with it would take"""

    def __post_init__(self) -> None:
        self.bids_s = [self._best(goal)[0] for goal in range(self.goals)]

    def take(self, goal: int) -> None:
        """Puts a goal won into the path and bids anew."""
        self.path.insert(self._best(goal)[1], goal)
        self.bids_s = [self._best(other)[0] for other in range(self.goals)]

    def _best(self, goal: int) -> tuple[float, int]:
        """Duration of the path with a goal in it where it costs least, and that place."""
        if goal in self.path:
            return inf, 0
        return min(
            (self._duration_s([*self.path[:place], goal, *self.path[place:]]), place)
            for place in range(len(self.path) + 1)
        )

    def _duration_s(self, path: Sequence[int]) -> float:
        return self.start_s[path[0]] + sum(self.between_s[b][a] for a, b in pairwise(path))
