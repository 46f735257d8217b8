"""Shortest paths between places on the map of one class of robots, computed once a pair."""

from collections import OrderedDict
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import inf
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from semantic_attachments._core import AnyAngleField, Field, Traversability
from semantic_attachments.world import Blockade

T = TypeVar("T")

FIELD_MEMORY_BYTES = 256 * 2**20
"""Fields of one class of robots are dropped, oldest first, above this memory."""


@dataclass(frozen=True, slots=True)
class Place:
    """A location as paths see it: a cell, and the blockade that is open there."""

    cell: int
    blockade: Blockade | None


Pair = tuple[Place, Place]


def ordered(first: Place, second: Place) -> Pair:
    """The pair in an order that does not depend on the direction of travel."""

    def rank(place: Place) -> tuple[int, str]:
        return place.cell, "" if place.blockade is None else place.blockade.id

    return (first, second) if rank(first) <= rank(second) else (second, first)


@dataclass(frozen=True, slots=True)
class Leg:
    """The shortest path of a pair."""

    length: float
    """In cells times multiplier; infinite where there is no way."""
    path: NDArray[np.uint32]
    """(n,) cells from the first place to the second, those on which the robot can stand."""
    snapped: tuple[bool, bool]
    """Whether each end is too near to an obstacle to stand on: the path begins beside it."""

    def reversed(self) -> "Leg":
        """The way back."""
        return Leg(self.length, self.path[::-1], (self.snapped[1], self.snapped[0]))


@dataclass(slots=True)
class Layer:
    """The map of one class of robots and what was computed on it."""

    traversability: Traversability
    blockades: tuple[Blockade, ...]
    snap_limit_cells: float
    """How far from its place a path may begin: out of a robot's own inflation and some cells."""
    any_angle: bool = False
    """Whether paths are straight lines between cells that see each other."""
    legs: dict[Pair, Leg] = field(default_factory=dict)
    fields: "OrderedDict[tuple[int, Blockade | None], Field]" = field(default_factory=OrderedDict)
    lines: "OrderedDict[tuple[int, tuple[int, ...]], AnyAngleField]" = field(
        default_factory=OrderedDict
    )
    grown: int = 0
    """One-to-all searches so far."""
    roomy: Traversability | None = None
    """The same with half a cell more room, for straight lines between cell centres."""

    def opened(self, *places: Place) -> list[int]:
        """Numbers of the blockades that are open at places."""
        known = {place.blockade for place in places if place.blockade is not None}
        return [index for index, blockade in enumerate(self.blockades) if blockade in known]

    def compute(self, pairs: Iterable[Pair]) -> None:
        """Computes the legs of pairs that have none."""
        missing = [pair for pair in pairs if pair not in self.legs]
        if self.any_angle:
            self._compute_lines(missing)
        else:
            self._compute_from_few(missing)

    def _compute_from_few(self, pairs: Iterable[Pair]) -> None:
        """From as few sources as a greedy vertex cover finds."""
        partners: dict[Place, dict[Place, None]] = {}
        for first, second in pairs:
            partners.setdefault(first, {})[second] = None
            partners.setdefault(second, {})[first] = None
        grown = [place for place in partners if self._field_key(place) in self.fields]
        while partners:
            source = grown.pop() if grown else max(partners, key=lambda place: len(partners[place]))
            for goal in partners.pop(source):
                partners[goal].pop(source)
                if not partners[goal]:
                    del partners[goal]
                pair = ordered(source, goal)
                leg = self._leg(source, goal, self._along_steps)
                self.legs[pair] = leg if pair[0] == source else leg.reversed()
            grown = [place for place in grown if place in partners]

    def _compute_lines(self, pairs: Iterable[Pair]) -> None:
        """Each from one end that is always the same: lines found from the other may differ."""
        for first, second in sorted(pairs, key=lambda pair: pair[0].cell):
            backwards = second.blockade is not None and first.blockade is None
            if backwards:
                self.legs[first, second] = self._leg(second, first, self._along_lines).reversed()
            else:
                self.legs[first, second] = self._leg(first, second, self._along_lines)

    def _leg(
        self,
        source: Place,
        goal: Place,
        along: "Callable[[Place, Place, int, int], tuple[float, NDArray[np.uint32]]]",
    ) -> Leg:
        opened = self.opened(source, goal)
        start = self.traversability.nearest(source.cell, opened, self.snap_limit_cells)
        end = self.traversability.nearest(goal.cell, opened, self.snap_limit_cells)
        snapped = (
            start is None or start[0] != source.cell,
            end is None or end[0] != goal.cell,
        )
        if start is None or end is None:
            return Leg(inf, np.empty(0, dtype=np.uint32), snapped)
        length, path = along(source, goal, start[0], end[0])
        return Leg(start[1] + length + end[1], path, snapped)

    def _along_steps(
        self, source: Place, goal: Place, start: int, end: int
    ) -> tuple[float, NDArray[np.uint32]]:
        opened = self.opened(source, goal)
        key = self._field_key(source)
        if goal.blockade is None or goal.blockade == source.blockade:
            tree = self._field(start, source.blockade, opened)
        elif key is not None and key[0] == start:
            tree = self._field(start, source.blockade, self.opened(source))
            return self.traversability.reach(tree, end, opened)
        else:
            # The robot stands inside the blockade it goes to: its own cell is open only then.
            tree = self.traversability.field(start, opened)
            self.grown += 1
        return tree.distance(end), tree.path_to(end)

    def _along_lines(
        self, source: Place, goal: Place, start: int, end: int
    ) -> tuple[float, NDArray[np.uint32]]:
        opened = self.opened(source, goal)
        key = (start, tuple(opened))
        tree = self.lines.get(key)
        if tree is None:
            tree = self.traversability.any_angle(start, opened)
            self.grown += 1
            self.lines[key] = tree
            _limit(self.lines, tree.nbytes)
        return tree.distance(end), tree.path_to(end)

    def _field_key(self, source: Place) -> tuple[int, Blockade | None] | None:
        start = self.traversability.nearest(source.cell, self.opened(source), self.snap_limit_cells)
        return None if start is None else (start[0], source.blockade)

    def _field(self, cell: int, blockade: Blockade | None, opened: list[int]) -> Field:
        key = (cell, blockade)
        tree = self.fields.get(key)
        if tree is None:
            tree = self.traversability.field(cell, opened)
            self.grown += 1
            self.fields[key] = tree
            _limit(self.fields, tree.nbytes)
        return tree


def _limit(trees: "OrderedDict[T, Field] | OrderedDict[T, AnyAngleField]", nbytes: int) -> None:
    while len(trees) > 1 and len(trees) * nbytes > FIELD_MEMORY_BYTES:
        trees.popitem(last=False)
