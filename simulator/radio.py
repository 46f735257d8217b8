"""Radio contact: which robots hear one another, directly or through others.

Everybody within a range hears everybody else (a disc, walls or no walls), and what somebody hears
it passes on.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from simulator.fleet_scenario import Point


@dataclass(frozen=True, slots=True)
class Groups:
    """Robots that hear one another at some time; every robot is in one group."""

    members: tuple[tuple[str, ...], ...]
    """in the fleet's order, and so are the groups by their first members"""
    linked: int | None
    """index of the group that hears the base station; None if nobody does"""

    @property
    def of_base(self) -> tuple[str, ...]:
        """The robots that the service hears and that hear it."""
        return () if self.linked is None else self.members[self.linked]


@dataclass(frozen=True, slots=True)
class Radio:
    """Who hears whom."""

    range_m: float
    """how far a radio is heard"""
    base_m: Point
    """where the service's own radio stands"""

    def groups(self, positions_m: Mapping[str, Point], silent: Collection[str] = ()) -> Groups:
        """The groups of robots that hear one another; those that are silent hear nobody.

        Args:
            positions_m: where the robots are.
            silent: robots whose radio is dead.
        """
        names = list(positions_m)
        group = list(range(len(names)))

        def root(i: int) -> int:
            while group[i] != i:
                group[i] = group[group[i]]
                i = group[i]
            return i

        heard = [i for i, name in enumerate(names) if name not in silent]
        for place, i in enumerate(heard):
            for j in heard[:place]:
                if math.dist(positions_m[names[i]], positions_m[names[j]]) <= self.range_m:
                    one, other = sorted((root(i), root(j)))
                    group[other] = one
        by_base = {
            root(i) for i in heard if math.dist(positions_m[names[i]], self.base_m) <= self.range_m
        }
        members: dict[int, list[str]] = {}
        for i, name in enumerate(names):
            first = root(i)
            # Groups that hear the base hear one another through it.
            members.setdefault(min(by_base) if first in by_base else first, []).append(name)
        ordered = list(members.items())
        linked = next((k for k, (first, _) in enumerate(ordered) if first in by_base), None)
        return Groups(tuple(tuple(names) for _, names in ordered), linked)


def everybody(names: Collection[str]) -> Groups:
    """A fleet in which everybody hears everybody, and the base."""
    return Groups((tuple(names),), 0)
