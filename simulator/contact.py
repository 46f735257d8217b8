"""Who knows what as robots part and meet: one `Knowledge` for each group that is in contact.

Without a radio of limited range there is one group for ever.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from simulator.fleet_scenario import Point
from simulator.knowledge import Knowledge
from simulator.radio import Groups, Radio, everybody
from simulator.robot import Robot


class Contact(Mapping[str, Knowledge]):
    """Each robot's knowledge; the base station's is what the service is told of."""

    def __init__(self, robots: Sequence[Robot], knowledge: Knowledge, radio: Radio | None) -> None:
        self.radio = radio
        self.base = knowledge
        """what the service's own radio knows"""
        self.groups = everybody([robot.id for robot in robots])
        self.linked = frozenset(self.groups.of_base)
        """robots in contact with the service"""
        self.last_linked_m: dict[str, Point] = {robot.id: robot.position for robot in robots}
        """where each robot was when it last was in contact with the service"""
        self._knowledge = {robot.id: knowledge for robot in robots}

    def __getitem__(self, robot: str) -> Knowledge:
        return self._knowledge[robot]

    def __iter__(self) -> Iterator[str]:
        return iter(self._knowledge)

    def __len__(self) -> int:
        return len(self._knowledge)

    def update(self, robots: Sequence[Robot]) -> list[tuple[str, ...]]:
        """Looks who is in contact now; the groups that have met, and so may know more.

        A dead robot's radio is dead, too.
        """
        if self.radio is None:
            return []
        positions_m = {robot.id: robot.truth[:2] for robot in robots}
        groups = self.radio.groups(positions_m, {r.id for r in robots if r.has_failed})
        met = self._regroup(groups) if groups != self.groups else []
        for robot in robots:
            if robot.id in self.linked:
                self.last_linked_m[robot.id] = robot.position
        return met

    def _regroup(self, groups: Groups) -> list[tuple[str, ...]]:
        """Copies for those that part, one knowledge for those that meet."""
        met = []
        sources: list[list[Knowledge]] = []
        for index, members in enumerate(groups.members):
            known = [self._knowledge[robot] for robot in members]
            if index == groups.linked:
                known.insert(0, self.base)
            sources.append(_distinct(known))
            if len(sources[-1]) > 1:
                met.append(members)
        if groups.linked is None:
            sources.append([self.base])
        shares = Counter(id(one) for known in sources for one in known)
        joined = [_joined(known, kept=shares[id(known[0])] == 1) for known in sources]
        self.base = joined[-1 if groups.linked is None else groups.linked]
        for members, joint in zip(groups.members, joined, strict=False):
            for robot in members:
                self._knowledge[robot] = joint
        self.groups, self.linked = groups, frozenset(groups.of_base)
        return met

    def out_of_touch(self) -> list[Knowledge]:
        """What the groups know that the service does not hear."""
        return [one for one in _distinct(list(self._knowledge.values())) if one is not self.base]

    def everything(self) -> Knowledge:
        """All that anybody knows."""
        return _joined(_distinct([self.base, *self._knowledge.values()]), kept=False)


def _distinct(known: Sequence[Knowledge]) -> list[Knowledge]:
    return list({id(one): one for one in known}.values())


def _joined(known: Sequence[Knowledge], *, kept: bool) -> Knowledge:
    """All that is known in one; the first one itself if nobody else keeps it."""
    first, *others = known
    joint = first if kept else first.copy()
    if others:
        joint.merge(others)
    return joint
