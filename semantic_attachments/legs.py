"""Shortest paths between places on the map of one class of robots, computed once a pair."""

from collections import OrderedDict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from math import inf, isnan
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

    @property
    def rank(self) -> tuple[int, str]:
        """Places are numbered in this order."""
        return self.cell, "" if self.blockade is None else self.blockade.id


Pair = tuple[int, int]
"""Numbers of two places, the lower one first: travel is the same in both directions."""

FieldKey = tuple[int, Blockade | None]
"""The cell that a field was grown from and the blockade that was open."""


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

    places: Sequence[Place]
    """All places, by their numbers."""
    traversability: Traversability
    blockades: tuple[Blockade, ...]
    snap_limit_cells: float
    """How far from its place a path may begin: out of a robot's own inflation and some cells."""
    any_angle: bool = False
    """Whether paths are straight lines between cells that see each other."""
    legs: dict[Pair, Leg] = field(default_factory=dict)
    fields: "OrderedDict[FieldKey, Field]" = field(default_factory=OrderedDict)
    stale: "OrderedDict[FieldKey, Field]" = field(default_factory=OrderedDict)
    """Fields of the map before, which are repaired when they are needed."""
    lines: "OrderedDict[tuple[int, tuple[int, ...]], AnyAngleField]" = field(
        default_factory=OrderedDict
    )
    grown: int = 0
    """One-to-all searches so far."""
    repaired: int = 0
    """Fields repaired so far."""
    cells_repaired: int = 0
    """Cells computed for them."""
    roomy: Traversability | None = None
    """The same with half a cell more room, for straight lines between cell centres."""

    def opened(self, *places: Place) -> list[int]:
        """Numbers of the blockades that are open at places."""
        known = [place.blockade for place in places if place.blockade is not None]
        return sorted({self.blockades.index(blockade) for blockade in known})

    def compute(self, pairs: Iterable[Pair]) -> None:
        """Computes the legs of pairs that have none."""
        missing = [pair for pair in pairs if pair not in self.legs]
        if self.any_angle:
            self._compute_lines(missing)
        else:
            self._compute_from_few(missing)

    def _compute_from_few(self, pairs: Iterable[Pair]) -> None:
        """From as few sources as a greedy vertex cover finds."""
        partners: dict[int, dict[int, None]] = {}
        for first, second in pairs:
            partners.setdefault(first, {})[second] = None
            partners.setdefault(second, {})[first] = None
        keys = {number: self._field_key(self.places[number]) for number in partners}
        grown = [number for number in partners if keys[number] in self.fields]
        while partners:
            # Among those that serve as many pairs, one whose field need not be grown anew.
            source = (
                grown.pop()
                if grown
                else max(partners, key=lambda n: (len(partners[n]), keys[n] in self.stale))
            )
            goals = list(partners.pop(source))
            for goal in goals:
                partners[goal].pop(source)
                if not partners[goal]:
                    del partners[goal]
            self._compute_from(source, goals, keys[source])
            grown = [number for number in grown if number in partners]

    def _compute_from(self, source: int, goals: Sequence[int], key: FieldKey | None) -> None:
        place = self.places[source]
        if key is None:
            legs = [self._alone(place, self.places[goal]) for goal in goals]
        else:
            numbers = {blockade: number for number, blockade in enumerate(self.blockades)}
            ends = [
                (end.cell, None if end.blockade is None else numbers[end.blockade])
                for end in (place, *(self.places[goal] for goal in goals))
            ]
            lengths, from_beside, to_beside, cells, stops = self.traversability.legs(
                self._field(key), ends[0], ends[1:], self.snap_limit_cells
            )
            starts = [0, *stops]
            legs = [
                self._alone(place, self.places[goal])
                if isnan(lengths[i])
                else Leg(lengths[i], cells[starts[i] : stops[i]], (from_beside[i], to_beside[i]))
                for i, goal in enumerate(goals)
            ]
        for goal, leg in zip(goals, legs, strict=True):
            self.legs[min(source, goal), max(source, goal)] = (
                leg if source < goal else leg.reversed()
            )

    def _compute_lines(self, pairs: Iterable[Pair]) -> None:
        """Each from one end that is always the same: lines found from the other may differ."""
        for first, second in sorted(pairs):
            start, goal = self.places[first], self.places[second]
            backwards = goal.blockade is not None and start.blockade is None
            leg = self._lines(goal, start).reversed() if backwards else self._lines(start, goal)
            self.legs[first, second] = leg

    def _alone(self, source: Place, goal: Place) -> Leg:
        """The robot stands inside the blockade it goes to: its own cell is open only then."""
        opened = self.opened(source, goal)
        ends, snapped = self._ends(source, goal, opened)
        if ends is None:
            return Leg(inf, np.empty(0, dtype=np.uint32), snapped)
        (start, out), (end, into) = ends
        tree = self.traversability.field(start, opened)
        self.grown += 1
        return Leg(out + tree.distance(end) + into, tree.path_to(end), snapped)

    def _lines(self, source: Place, goal: Place) -> Leg:
        opened = self.opened(source, goal)
        ends, snapped = self._ends(source, goal, opened)
        if ends is None:
            return Leg(inf, np.empty(0, dtype=np.uint32), snapped)
        (start, out), (end, into) = ends
        key = (start, tuple(opened))
        tree = self.lines.get(key)
        if tree is None:
            tree = self.traversability.any_angle(start, opened)
            self.grown += 1
            self.lines[key] = tree
            _limit(self.lines, tree.nbytes)
        return Leg(out + tree.distance(end) + into, tree.path_to(end), snapped)

    def _ends(
        self, source: Place, goal: Place, opened: list[int]
    ) -> tuple[tuple[tuple[int, float], tuple[int, float]] | None, tuple[bool, bool]]:
        """Where a path begins and ends, each with its distance from the place; whether beside."""
        start = self.traversability.nearest(source.cell, opened, self.snap_limit_cells)
        end = self.traversability.nearest(goal.cell, opened, self.snap_limit_cells)
        snapped = (
            start is None or start[0] != source.cell,
            end is None or end[0] != goal.cell,
        )
        return (None if start is None or end is None else (start, end)), snapped

    def _field_key(self, source: Place) -> FieldKey | None:
        start = self.traversability.nearest(source.cell, self.opened(source), self.snap_limit_cells)
        return None if start is None else (start[0], source.blockade)

    def _field(self, key: FieldKey) -> Field:
        tree = self.fields.get(key)
        if tree is not None:
            return tree
        cell, blockade = key
        opened = [] if blockade is None else [self.blockades.index(blockade)]
        old = self.stale.pop(key, None)
        repaired = None if old is None else self.traversability.repair(old, opened)
        if repaired is None:
            tree = self.traversability.field(cell, opened)
            self.grown += 1
        else:
            tree, cells = repaired
            self.repaired += 1
            self.cells_repaired += cells
        self.fields[key] = tree
        _limit(self.stale, tree.nbytes, len(self.fields))
        _limit(self.fields, tree.nbytes)
        return tree


def _limit(
    trees: "OrderedDict[T, Field] | OrderedDict[T, AnyAngleField]", nbytes: int, others: int = 1
) -> None:
    while trees and (len(trees) + others - 1) * nbytes > FIELD_MEMORY_BYTES:
        trees.popitem(last=False)
