"""Sequential single-item auctions (Lagoudakis et al., "Auction-Based Multi-Robot Routing", 2005).

In every round each robot bids, for each target nobody has yet, the time at which it would be done
with all its targets if it took that one in as well where it fits best (bidding rule MiniMax for
paths, cheapest insertion); the lowest bid wins. Only the first target of each robot's path is
ordered: the auction is held anew at every event, like every other strategy's decision.

A robot keeps the target that it is driving to, unless an auction of that one too makes the longest
path much shorter: cheapest insertion is not consistent from one place to the next, and a robot
between two targets could turn round at every auction for ever.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import inf, isfinite

from service.coordination.travel import Travel

KEPT_UNLESS_BETTER = 0.15
"""By what share the longest path must be shorter for robots to turn to other targets.

Of 300 robots among six to twelve random targets that bid after every metre, six turn to and fro for
ever at 0.03, one at 0.1, none at 0.15.
"""


def auction(
    travel: Travel, robots: Sequence[str], goals: Sequence[str], *, share: bool = False
) -> dict[int, int]:
    """Index of each robot's first goal; a robot that wins nothing it can reach is not in it.

    Args:
        share: robots that win nothing go to the goal that is nearest to them, whoever has it.
    """
    starts_s = travel.times_s(robots, goals)
    between_s = [[travel.times_between_s(robot, goals, goal) for goal in goals] for robot in robots]
    kept_by = _kept(travel.going, robots, goals, starts_s)
    bidders = _held(starts_s, between_s, {})
    if any(bidders[row].path[:1] != [goal] for row, goal in kept_by.items()):
        kept = _held(starts_s, between_s, kept_by)
        shorter = _longest_s(bidders) < _longest_s(kept) * (1.0 - KEPT_UNLESS_BETTER)
        if not shorter and _won(kept) >= _won(bidders):
            bidders = kept
    first = {row: bidder.path[0] for row, bidder in enumerate(bidders) if bidder.path}
    if share:
        for row in range(len(robots)):
            nearest = min(range(len(goals)), key=starts_s[row].__getitem__)
            if row not in first and isfinite(starts_s[row][nearest]):
                first[row] = nearest
    return first


def _kept(
    going: Mapping[str, str],
    robots: Sequence[str],
    goals: Sequence[str],
    starts_s: Sequence[Sequence[float]],
) -> dict[int, int]:
    """Index of the goal that each robot keeps; of two that go to the same one, the nearer does."""
    under_way = [
        (time_s, row, goal)
        for row, robot in enumerate(robots)
        if (place := going.get(robot)) in goals
        and isfinite(time_s := starts_s[row][goal := goals.index(place)])
    ]
    keepers: dict[int, int] = {}
    for _, row, goal in sorted(under_way):
        keepers.setdefault(goal, row)
    return {row: goal for goal, row in keepers.items()}


def _held(
    starts_s: Sequence[Sequence[float]],
    between_s: Sequence[Sequence[Sequence[float]]],
    kept_by: Mapping[int, int],
) -> list["_Bidder"]:
    """The bidders after an auction of all goals that nobody keeps."""
    bidders = [
        _Bidder(start_s, between_s[row], len(start_s), kept_by.get(row))
        for row, start_s in enumerate(starts_s)
    ]
    left = {goal for start_s in starts_s for goal in range(len(start_s))} - set(kept_by.values())
    while left:
        bid_s, winner, goal = min(
            (bidder.bids_s[goal], row, goal) for row, bidder in enumerate(bidders) for goal in left
        )
        if not isfinite(bid_s):
            break
        bidders[winner].take(goal)
        left.discard(goal)
    return bidders


def _won(bidders: Sequence["_Bidder"]) -> set[int]:
    return {goal for bidder in bidders for goal in bidder.path}


def _longest_s(bidders: Sequence["_Bidder"]) -> float:
    return max((bidder.duration_s for bidder in bidders), default=0.0)


@dataclass
class _Bidder:
    """A robot's path through the goals it has won."""

    start_s: Sequence[float]
    """from where it is to each goal"""
    between_s: Sequence[Sequence[float]]
    """[goal][from]"""
    goals: int
    kept: int | None = None
    """the goal that it drives to and keeps as the first one"""
    path: list[int] = field(default_factory=list)
    bids_s: list[float] = field(init=False)
    """for each goal, how long the path with it would take"""

    def __post_init__(self) -> None:
        if self.kept is not None:
            self.path.append(self.kept)
        self.bids_s = [self._best(goal)[0] for goal in range(self.goals)]

    @property
    def duration_s(self) -> float:
        """Of the whole path."""
        return self._duration_s(self.path) if self.path else 0.0

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
            for place in range(int(self.kept is not None), len(self.path) + 1)
        )

    def _duration_s(self, path: Sequence[int]) -> float:
        return self.start_s[path[0]] + sum(self.between_s[b][a] for a, b in pairwise(path))
