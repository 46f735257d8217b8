"""Travel times and paths between the places of a mission, by the mission's ids."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf

from domains import catalogue
from domains.formulation import place_of
from semantic_attachments.contract import Memory
from semantic_attachments.grid import path_costs
from service.coordination.strategy import Situation
from service.messages.base import Position


class Travel:
    """One situation's travel times [s]; infinite where there is no way.

    Every known blockade is a wall, save the one at either end of the way (thesis 3.5.1).
    """

    def __init__(self, situation: Situation, memory: Memory) -> None:
        self.situation = situation
        self.formulation = catalogue.load(situation.domain)
        self.names = self.formulation.names(situation.state)
        self.world = self.formulation.world(
            situation.state, situation.grid, situation.models, situation.version
        )
        self._costs = path_costs(self.world, memory)
        self._avoid = situation.avoid

    @classmethod
    def of(cls, situation: Situation, memory: Memory) -> "Travel":
        """Those of a situation, made once while it is the latest that the memory has seen."""
        kept = memory.get("travel", Travel)
        if kept is not None and kept.situation is situation:
            return kept
        travel = cls(situation, memory)
        memory.keep("travel", travel)
        return travel

    @property
    def going(self) -> Mapping[str, str]:
        """Where robots are driving to now."""
        return self.situation.going

    def times_s(self, robots: Sequence[str], goals: Sequence[str]) -> list[list[float]]:
        """Travel times of each robot, from where it is now, to each goal."""
        calls = [
            (self.names.name(robot), self.names.name(place_of(robot)), self.names.name(goal))
            for robot in robots
            for goal in goals
        ]
        flat = iter(self._costs.many(calls))
        return [
            [
                inf if (robot, goal) in self._avoid else time_s
                for goal, time_s in zip(goals, flat, strict=False)
            ]
            for robot in robots
        ]

    def times_between_s(self, robot: str, starts: Sequence[str], goal: str) -> list[float]:
        """Travel times of a robot from several places to a goal."""
        name, to = self.names.name(robot), self.names.name(goal)
        if (robot, goal) in self._avoid:
            return [inf] * len(starts)
        return self._costs.many([(name, self.names.name(start), to) for start in starts])

    def path_m(self, robot: str, goal: str) -> tuple[Position, ...]:
        """Way points from where a robot is now to a goal; empty where there is no way."""
        way_points = self._costs.path(
            self.names.name(robot), self.names.name(place_of(robot)), self.names.name(goal)
        )
        return tuple((round(float(x), 4), round(float(y), 4)) for x, y in way_points)


def as_if_everywhere(situation: Situation) -> Travel:
    """Travel times of robots that could drive on all ground, and through every gap that the
    smallest of them fits through."""
    smallest_m = min(model.radius_m for model in situation.models.values())
    free = {
        name: replace(model, enters=situation.grid.terrain_classes, radius_m=smallest_m)
        for name, model in situation.models.items()
    }
    # A memory of its own: such ways must not mix with those that robots can really drive.
    return Travel(replace(situation, models=free), Memory())
