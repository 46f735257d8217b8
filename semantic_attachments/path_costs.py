"""Travel times between named places (Wurm, sections 3.4.1 and 3.5.1): `C(x, t)` of each robot.

Every known blockade is a wall, save the one that a robot starts from or goes to. Costs do not
depend on the direction of travel, so each pair of places is computed once, from whichever end
serves more pairs.

What is kept across replans is the pairs: a pair is forgotten only if a cell of its path was closed,
or if opened cells lie where a shorter path could run (no octile path through them is longer).
"""

from collections import OrderedDict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from math import inf, isfinite
from threading import RLock

import numpy as np
from numpy.typing import NDArray

from semantic_attachments._core import Field, Traversability
from semantic_attachments.contract import EvaluationError
from semantic_attachments.map_change import MapChange
from semantic_attachments.robot_class import GridParameters, RobotClass, fastest_m_s
from semantic_attachments.world import Blockade, GridMap, Location, World

FIELD_MEMORY_BYTES = 256 * 2**20
"""Fields of one class of robots are dropped, oldest first, above this memory."""


@dataclass(frozen=True, slots=True)
class Place:
    """A location as paths see it: a cell, and the blockade that is open there."""

    cell: int
    blockade: Blockade | None


Pair = tuple[Place, Place]


@dataclass(frozen=True, slots=True)
class Leg:
    """The shortest path of a pair."""

    length: float
    """In cells times multiplier; infinite where there is no way."""
    path: NDArray[np.uint32]
    """(n,) cells from the first place to the second, those on which the robot can stand."""
    snapped: tuple[bool, bool]
    """Whether each end is too near to an obstacle to stand on, so that the path begins beside
    it."""


@dataclass(slots=True)
class Statistics:
    """Counts of the work done."""

    fields: int = 0
    """One-to-all searches."""
    kept: int = 0
    """Pairs taken over from the world before."""
    forgotten: int = 0
    """Pairs that a change of the map could touch."""


@dataclass(slots=True)
class Layer:
    """The map of one class of robots and what was computed on it."""

    traversability: Traversability
    blockades: tuple[Blockade, ...]
    snap_limit_cells: float
    """How far from its place a path may begin: out of a robot's own inflation and some cells."""
    fields: "OrderedDict[tuple[int, Blockade | None], Field]" = field(default_factory=OrderedDict)
    legs: dict[Pair, Leg] = field(default_factory=dict)
    roomy: Traversability | None = None
    """The same with half a cell more room, for straight lines between cell centres."""

    def opened(self, *places: Place) -> list[int]:
        """Numbers of the blockades that are open at places."""
        known = {place.blockade for place in places if place.blockade is not None}
        return [index for index, blockade in enumerate(self.blockades) if blockade in known]


class PathCosts:
    """Evaluator of `pathCost(robot, from, to)` in seconds; may be asked by several threads."""

    def __init__(self, world: World, parameters: GridParameters | None = None) -> None:
        self.world = world
        self.parameters = parameters or GridParameters()
        self.statistics = Statistics()
        self._layers: dict[RobotClass, Layer] = {}
        self._lock = RLock()
        self._places = {
            name: self._place(location) for name, location in sorted(world.locations.items())
        }

    def after(self, world: World) -> "PathCosts":
        """The path costs of a changed world, with every pair that the change cannot touch."""
        costs = PathCosts(world, self.parameters)
        before = self.world.grid
        with self._lock:
            same_frame = (before.cells.shape, before.resolution_m, before.origin_m) == (
                world.grid.cells.shape,
                world.grid.resolution_m,
                world.grid.origin_m,
            )
            if same_frame and before.terrain_classes == world.grid.terrain_classes:
                for robot_class, layer in self._layers.items():
                    costs._layers[robot_class] = costs._take_over(robot_class, layer, before)
        return costs

    def __call__(self, *arguments: str) -> float:
        """Travel time [s] of (robot, from, to); infinite if there is no way."""
        return self.many([arguments])[0]

    def many(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
        """Travel times [s] of many (robot, from, to), in their order.

        Raises:
            EvaluationError: if the world has no such robot or location.
        """
        with self._lock:
            wanted: dict[RobotClass, dict[Pair, None]] = {}
            resolved = []
            for call in calls:
                robot_class, speed_m_s, start, goal = self._resolve(call)
                resolved.append((robot_class, speed_m_s, start, goal))
                if start is not None and goal is not None and start != goal:
                    wanted.setdefault(robot_class, {})[_ordered(start, goal)] = None
            for robot_class, pairs in wanted.items():
                layer = self._layer(robot_class)
                self._compute(layer, [pair for pair in pairs if pair not in layer.legs])
            return [self._duration_s(*entry) for entry in resolved]

    def path(self, robot: str, start: str, goal: str) -> NDArray[np.float64]:
        """(n, 2) way points [m] from one location to another, none if there is no way.

        Straight lines join them wherever the robot has half a cell to spare.
        """
        with self._lock:
            robot_class, _, first, last = self._resolve((robot, start, goal))
            ends = [self.world.locations[name].position_m for name in (start, goal)]
            if first is None or last is None:
                return np.empty((0, 2))
            if first == last:
                return np.array(ends)
            layer = self._layer(robot_class)
            pair = _ordered(first, last)
            if pair not in layer.legs:
                self._compute(layer, [pair])
            leg = layer.legs[pair]
            if not isfinite(leg.length):
                return np.empty((0, 2))
            if layer.roomy is None:
                layer.roomy = robot_class.traversability(
                    self.world.grid,
                    layer.blockades,
                    self.parameters,
                    extra_radius_m=self.world.grid.resolution_m / 2,
                )
            cells = layer.roomy.way_points(leg.path, layer.opened(*pair))
            snapped = leg.snapped
            if pair != (first, last):
                cells, snapped = cells[::-1], (snapped[1], snapped[0])
            inner = self.world.grid.centres_m(cells)[
                0 if snapped[0] else 1 : None if snapped[1] else -1
            ]
            return np.vstack([ends[:1], inner, ends[1:]])

    def length_m(self, robot: str, start: str, goal: str) -> float:
        """Length of the shortest path [m], as if driven at the robot's fastest speed throughout."""
        speed_m_s = fastest_m_s(self.world.robots[robot])
        return self(robot, start, goal) * speed_m_s

    def _resolve(
        self, call: tuple[str, ...]
    ) -> tuple[RobotClass, float, Place | None, Place | None]:
        if len(call) != 3:
            raise EvaluationError(f"pathCost takes a robot and two locations, not {call}")
        robot, start, goal = call
        model = self.world.robots.get(robot)
        if model is None:
            raise EvaluationError(f"the world has no robot {robot!r}")
        for name in (start, goal):
            if name not in self._places:
                raise EvaluationError(f"the world has no location {name!r}")
        robot_class = RobotClass.of(model, self.world.grid, self.parameters)
        return robot_class, fastest_m_s(model), self._places[start], self._places[goal]

    def _place(self, location: Location) -> Place | None:
        cell = self.world.grid.cell_at(location.position_m)
        blockade = location.blockade
        if cell is None:
            return None
        return Place(cell, None if blockade is None else self.world.blockades[blockade])

    def _duration_s(
        self, robot_class: RobotClass, speed_m_s: float, start: Place | None, goal: Place | None
    ) -> float:
        if start is None or goal is None:
            return inf
        if start == goal:
            return 0.0
        length = self._layers[robot_class].legs[_ordered(start, goal)].length
        # Nanoseconds: the sum of a path's steps depends on their order, that is on its end, in the
        # last bits.
        return round(length * self.world.grid.resolution_m / speed_m_s, 9)

    def _layer(self, robot_class: RobotClass) -> Layer:
        layer = self._layers.get(robot_class)
        if layer is None:
            blockades = tuple(self.world.blockades[name] for name in sorted(self.world.blockades))
            layer = Layer(
                robot_class.traversability(self.world.grid, blockades, self.parameters),
                blockades,
                snap_limit_cells=1.5 * robot_class.radius_m / self.world.grid.resolution_m + 3.0,
            )
            self._layers[robot_class] = layer
        return layer

    def _take_over(self, robot_class: RobotClass, old: Layer, before: GridMap) -> Layer:
        new = self._layer(robot_class)
        change = MapChange.between(
            (old.traversability, old.blockades, robot_class.multiplier(before, self.parameters)),
            (
                new.traversability,
                new.blockades,
                robot_class.multiplier(self.world.grid, self.parameters),
            ),
        )
        if change is None:
            new.fields = OrderedDict(old.fields)
            new.roomy = old.roomy
        places = {place for place in self._places.values() if place is not None}
        legs = {
            pair: leg for pair, leg in old.legs.items() if pair[0] in places and pair[1] in places
        }
        if change is not None:
            touched = change.touches(
                [(pair[0].cell, pair[1].cell, leg) for pair, leg in legs.items()],
                new.snap_limit_cells,
            )
            self.statistics.forgotten += int(touched.sum())
            legs = {
                pair: leg for (pair, leg), hit in zip(legs.items(), touched, strict=True) if not hit
            }
        self.statistics.kept += len(legs)
        new.legs = legs
        return new

    def _compute(self, layer: Layer, pairs: Iterable[Pair]) -> None:
        """Computes pairs from as few sources as a greedy vertex cover finds."""
        partners: dict[Place, dict[Place, None]] = {}
        for first, second in pairs:
            partners.setdefault(first, {})[second] = None
            partners.setdefault(second, {})[first] = None
        grown = [place for place in partners if self._field_key(layer, place) in layer.fields]
        while partners:
            source = grown.pop() if grown else max(partners, key=lambda place: len(partners[place]))
            for goal in partners.pop(source, {}):
                partners[goal].pop(source)
                if not partners[goal]:
                    del partners[goal]
                leg = self._leg(layer, source, goal)
                pair = _ordered(source, goal)
                if pair[0] != source:
                    leg = Leg(leg.length, leg.path[::-1], (leg.snapped[1], leg.snapped[0]))
                layer.legs[pair] = leg
            grown = [place for place in grown if place in partners]

    def _leg(self, layer: Layer, source: Place, goal: Place) -> Leg:
        map_, limit = layer.traversability, layer.snap_limit_cells
        opened = layer.opened(source, goal)
        start = map_.nearest(source.cell, opened, limit)
        end = map_.nearest(goal.cell, opened, limit)
        snapped = (
            start is None or start[0] != source.cell,
            end is None or end[0] != goal.cell,
        )
        nowhere = np.empty(0, dtype=np.uint32)
        if start is None or end is None:
            return Leg(inf, nowhere, snapped)
        key = self._field_key(layer, source)
        if goal.blockade is None or goal.blockade == source.blockade:
            tree = self._field(layer, start[0], source.blockade, opened)
            length, path = tree.distance(end[0]), tree.path_to(end[0])
        elif key is not None and key[0] == start[0]:
            tree = self._field(layer, start[0], source.blockade, layer.opened(source))
            length, path = map_.reach(tree, end[0], opened)
        else:
            # The robot stands inside the blockade it goes to: its own cell is open only then.
            tree = map_.field(start[0], opened)
            self.statistics.fields += 1
            length, path = tree.distance(end[0]), tree.path_to(end[0])
        return Leg(start[1] + length + end[1], path, snapped)

    def _field_key(self, layer: Layer, source: Place) -> tuple[int, Blockade | None] | None:
        opened, limit = layer.opened(source), layer.snap_limit_cells
        start = layer.traversability.nearest(source.cell, opened, limit)
        return None if start is None else (start[0], source.blockade)

    def _field(
        self, layer: Layer, cell: int, blockade: Blockade | None, opened: list[int]
    ) -> Field:
        key = (cell, blockade)
        tree = layer.fields.get(key)
        if tree is None:
            tree = layer.traversability.field(cell, opened)
            self.statistics.fields += 1
            layer.fields[key] = tree
            while len(layer.fields) > 1 and len(layer.fields) * tree.nbytes > FIELD_MEMORY_BYTES:
                layer.fields.popitem(last=False)
        return tree


def _ordered(first: Place, second: Place) -> Pair:
    def rank(place: Place) -> tuple[int, str]:
        return place.cell, "" if place.blockade is None else place.blockade.id

    return (first, second) if rank(first) <= rank(second) else (second, first)
