"""One planner for each cluster of robots that hear one another (Wurm, end of section 2.5)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from scenarios.exploration.coordination import StrategyAtWork
from simulator.kinematic_exploration import Errand, TeamView


@dataclass
class PlannerPerCluster:
    """Keeps the clusters' planners apart; the planner of a new cluster knows what those of its
    members knew, and nothing of what others have found out meanwhile."""

    planner: Callable[[], StrategyAtWork]
    """makes a planner that knows nothing"""
    planners: list[StrategyAtWork] = field(default_factory=list)
    """all that there have ever been"""
    _of_robot: dict[str, StrategyAtWork] = field(default_factory=dict)
    _of_members: dict[frozenset[str], StrategyAtWork] = field(default_factory=dict)

    def __call__(self, view: TeamView) -> Mapping[str, Errand]:
        """The errands of one cluster of robots, from its planner."""
        if view.members not in self._of_members:
            self._form(view.members)
        return self._of_members[view.members](view)

    def _form(self, members: frozenset[str]) -> None:
        """A planner for robots that have met, or parted from others."""
        before: list[StrategyAtWork] = []
        for robot in sorted(members):
            if robot in self._of_robot and self._of_robot[robot] not in before:
                before.append(self._of_robot[robot])
        planner = self.planner()
        planner.take_over(before, members)
        self.planners.append(planner)
        self._of_members = {
            others: at_work for others, at_work in self._of_members.items() if not others & members
        }
        self._of_members[members] = planner
        self._of_robot |= dict.fromkeys(members, planner)

    @property
    def decision_cpu_s(self) -> list[float]:
        """CPU time of each decision of any planner [s]."""
        return [cpu_s for planner in self.planners for cpu_s in planner.decision_cpu_s]

    @property
    def target_counts(self) -> list[int]:
        """Number of targets at each decision of any planner."""
        return [count for planner in self.planners for count in planner.target_counts]
