"""What robots that hear one another know together, and what of it the service has not been told.

Robots in contact share one `Knowledge`; those that part take copies along, those that meet merge
theirs (see `contact`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from simulator.fleet_client import Command
from simulator.fleet_scenario import HiddenBlockade, Point
from simulator.mapping.sensed_map import SensedMap
from simulator.navigation import Navigation


@dataclass(frozen=True, slots=True)
class Ending:
    """A command that a robot has carried out, or given up."""

    robot: str
    command: str
    time_s: float
    position_m: Point
    """where the robot was"""
    reason: str | None = None
    """why it gave up; None if it has carried the command out"""


@dataclass(frozen=True, slots=True)
class Order:
    """What the service last wanted a robot to do, as far as is known."""

    number: int
    """of the report that it answered: the higher, the newer"""
    command: Command | None


@dataclass(slots=True)
class Knowledge:
    """What a group of robots knows."""

    navigation: Navigation
    """the map, standing blockades and dead robots, for finding ways"""
    sensed_map: SensedMap | None = None
    """what has been seen of an unknown building"""
    sensed: dict[str, float] = field(default_factory=dict)
    """blockade -> time it was first sensed [s], of those cleared since as well"""
    cleared: set[str] = field(default_factory=set)
    """blockades known to be gone"""
    dead: dict[str, None] = field(default_factory=dict)
    """robots known to be dead, in the order of their deaths"""
    orders: dict[str, Order] = field(default_factory=dict)
    """robot -> its newest order that somebody in the group has heard"""
    endings: list[Ending] = field(default_factory=list)
    """those the service has not been told"""
    untold: list[str] = field(default_factory=list)
    """blockades that it has not been told"""
    told: set[str] = field(default_factory=set)
    """commands and blockades that it has been told"""
    began_work: bool = False
    """somebody began what cannot be interrupted, since the last report"""

    # --- learning ---

    def sense(self, blockade: HiddenBlockade, time_s: float) -> bool:
        """A blockade stands; True if that is new."""
        if blockade.id in self.sensed:
            return False
        self.sensed[blockade.id] = time_s
        self.untold.append(blockade.id)
        self.navigation.known[blockade.id] = blockade
        return True

    def see_gone(self, blockade: str) -> None:
        """A blockade is gone."""
        self.cleared.add(blockade)
        self.navigation.known.pop(blockade, None)

    def see_dead(self, robot: str, disc: tuple[float, float, float] | None) -> None:
        """A robot is dead; its body (x, y, radius) is in the way unless it is aboard another."""
        self.dead.setdefault(robot)
        if disc is not None and disc not in self.navigation.standing:
            self.navigation.standing.append(disc)

    def study_map(self) -> None:
        """Finds ways on the map as it has been sensed by now."""
        if self.sensed_map is not None:
            self.navigation.learn(self.sensed_map.grid())

    # --- telling ---

    @property
    def has_news(self) -> bool:
        """Whether there is something that the service should hear at once."""
        return bool(self.endings or self.untold or self.began_work)

    def tell(self) -> None:
        """The service has been told everything."""
        self.told.update(self.untold)
        self.told.update(ending.command for ending in self.endings)
        self.endings, self.untold, self.began_work = [], [], False

    # --- parting and meeting ---

    def copy(self) -> Knowledge:
        """The same knowledge for robots that lose touch with the others."""
        return replace(
            self,
            navigation=self.navigation.copy(),
            sensed_map=None if self.sensed_map is None else self.sensed_map.copy(),
            sensed=dict(self.sensed),
            cleared=set(self.cleared),
            dead=dict(self.dead),
            orders=dict(self.orders),
            endings=list(self.endings),
            untold=list(self.untold),
            told=set(self.told),
        )

    def merge(self, others: Iterable[Knowledge]) -> None:
        """Takes over what others know, as robots do that meet; their knowledge stays as it is."""
        for other in others:
            self._merge(other)
        self.endings.sort(key=lambda ending: (ending.time_s, ending.robot))
        self.untold.sort(key=lambda name: (self.sensed[name], name))

    def _merge(self, other: Knowledge) -> None:
        self.told |= other.told
        self.cleared |= other.cleared
        for name, time_s in other.sensed.items():
            self.sensed[name] = min(time_s, self.sensed.get(name, time_s))
        known = self.navigation.known | other.navigation.known
        self.navigation.known = {n: b for n, b in known.items() if n not in self.cleared}
        for disc in other.navigation.standing:
            if disc not in self.navigation.standing:
                self.navigation.standing.append(disc)
        self.dead |= other.dead
        for robot, order in other.orders.items():
            mine = self.orders.get(robot)
            if mine is None or mine.number < order.number:
                self.orders[robot] = order
        endings = dict.fromkeys([*self.endings, *other.endings])
        self.endings = [ending for ending in endings if ending.command not in self.told]
        untold = dict.fromkeys([*self.untold, *other.untold])
        self.untold = [name for name in untold if name not in self.told]
        self.began_work |= other.began_work
        if self.sensed_map is not None and other.sensed_map is not None:
            self.sensed_map.merge(other.sensed_map)
            self.study_map()
