"""Travel times between named places (Wurm, sections 3.4.1 and 3.5.1): `C(x, t)` of each robot.

Every known blockade is a wall, save the one that a robot starts from or goes to. Costs do not
depend on the direction of travel, so each pair of places is computed once, from whichever end
serves more pairs.

What is kept across replans is the pairs: a pair is forgotten only if a cell of its path was closed,
or if opened cells lie where a shorter path could run (no octile path through them is longer). The
shortest-path trees of forgotten pairs are repaired where the change touches them.
"""

from collections import OrderedDict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from threading import RLock

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.contract import EvaluationError
from semantic_attachments.legs import Layer, Pair, Place
from semantic_attachments.map_change import MapChange
from semantic_attachments.robot_class import GridParameters, RobotClass, fastest_m_s
from semantic_attachments.world import GridMap, Location, World

Times = dict[tuple[str, ...], float]
"""Travel times [s] by the names of (from, to)."""


@dataclass(slots=True)
class Statistics:
    """Counts of the work done."""

    fields: int = 0
    """One-to-all searches."""
    repaired: int = 0
    """Shortest-path trees of the world before that were repaired."""
    cells_repaired: int = 0
    """Cells computed for them."""
    kept: int = 0
    """Pairs taken over from the world before."""
    forgotten: int = 0
    """Pairs that a change of the map could touch."""


class PathCosts:
    """Evaluator of `pathCost(robot, from, to)` in seconds; may be asked by several threads."""

    def __init__(self, world: World, parameters: GridParameters | None = None) -> None:
        self.world = world
        self.parameters = parameters or GridParameters()
        self.statistics = Statistics()
        self._lock = RLock()
        classes: dict[RobotClass, int] = {}
        self._robots = {
            name: (
                classes.setdefault(RobotClass.of(model, world.grid, self.parameters), len(classes)),
                fastest_m_s(model),
            )
            for name, model in world.robots.items()
        }
        self._classes = tuple(classes)
        alike: dict[tuple[int, float], Times] = {}
        self._told: dict[str, Times] = {
            name: alike.setdefault(kind, {}) for name, kind in self._robots.items()
        }
        """What was answered before, by robot; those that drive alike share it."""
        self._layers: dict[int, Layer] = {}
        """By the number of the robots' class."""
        places = {name: self._place(location) for name, location in world.locations.items()}
        known = {place for place in places.values() if place is not None}
        self._places = sorted(known, key=lambda place: place.rank)
        numbers = {place: number for number, place in enumerate(self._places)}
        self._number = {
            name: None if place is None else numbers[place] for name, place in places.items()
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
                for number, layer in self._layers.items():
                    robot_class = self._classes[number]
                    if robot_class in costs._classes:
                        costs._take_over(costs._classes.index(robot_class), layer, before)
        return costs

    def __call__(self, *arguments: str) -> float:
        """Travel time [s] of (robot, from, to); infinite if there is no way."""
        return self.many([arguments])[0]

    def many(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
        """Travel times [s] of many (robot, from, to), in their order.

        Raises:
            EvaluationError: if the world has no such robot or location.
        """
        nowhere: Times = {}
        told = self._told
        with self._lock:
            new = [call for call in calls if not call or call[1:] not in told.get(call[0], nowhere)]
            if new:
                self._tell(new)
            return [told[call[0]][call[1:]] for call in calls]

    def _tell(self, calls: Sequence[tuple[str, ...]]) -> None:
        """Computes what nobody has asked for yet."""
        wanted: dict[int, dict[Pair, None]] = {}
        resolved = []
        for call in calls:
            number, speed_m_s, start, goal = self._resolve(call)
            pair = None
            if start is not None and goal is not None:
                pair = (start, goal) if start < goal else (goal, start)
                if start != goal:
                    wanted.setdefault(number, {})[pair] = None
            resolved.append((number, speed_m_s, pair))
        for number, pairs in wanted.items():
            self._count(self._layer(number), pairs)
        for call, entry in zip(calls, resolved, strict=True):
            self._told[call[0]][call[1:]] = self._duration_s(*entry)

    def path(self, robot: str, start: str, goal: str) -> NDArray[np.float64]:
        """(n, 2) way points [m] from one location to another, none if there is no way.

        Straight lines join them wherever the robot has half a cell to spare.
        """
        with self._lock:
            number, _, first, last = self._resolve((robot, start, goal))
            ends = [self.world.locations[name].position_m for name in (start, goal)]
            if first is None or last is None:
                return np.empty((0, 2))
            if first == last:
                return np.array(ends)
            layer = self._layer(number)
            pair = (min(first, last), max(first, last))
            self._count(layer, [pair])
            leg = layer.legs[pair]
            if not isfinite(leg.length):
                return np.empty((0, 2))
            if layer.roomy is None:
                layer.roomy = self._classes[number].traversability(
                    self.world.grid,
                    layer.blockades,
                    self.parameters,
                    extra_radius_m=self.world.grid.resolution_m / 2,
                )
            cells = layer.roomy.way_points(
                leg.path, layer.opened(*(self._places[end] for end in pair))
            )
            snapped = leg.snapped
            if pair != (first, last):
                cells, snapped = cells[::-1], (snapped[1], snapped[0])
            inner = self.world.grid.centres_m(cells)[
                0 if snapped[0] else 1 : None if snapped[1] else -1
            ]
            return np.vstack([ends[:1], inner, ends[1:]])

    def length_m(self, robot: str, start: str, goal: str) -> float:
        """Length of the shortest path [m], as if driven at the robot's fastest speed throughout."""
        return self(robot, start, goal) * self._robots[robot][1]

    def _resolve(self, call: tuple[str, ...]) -> tuple[int, float, int | None, int | None]:
        """Number of the robot's class, its speed [m/s], numbers of the places; None is outside."""
        if len(call) != 3:
            raise EvaluationError(f"pathCost takes a robot and two locations, not {call}")
        robot, start, goal = call
        try:
            number, speed_m_s = self._robots[robot]
        except KeyError:
            raise EvaluationError(f"the world has no robot {robot!r}") from None
        try:
            return number, speed_m_s, self._number[start], self._number[goal]
        except KeyError as unknown:
            raise EvaluationError(f"the world has no location {unknown}") from None

    def _place(self, location: Location) -> Place | None:
        cell = self.world.grid.cell_at(location.position_m)
        blockade = location.blockade
        if cell is None:
            return None
        return Place(cell, None if blockade is None else self.world.blockades[blockade])

    def _duration_s(self, number: int, speed_m_s: float, pair: Pair | None) -> float:
        if pair is None:
            return inf
        if pair[0] == pair[1]:
            return 0.0
        length = self._layers[number].legs[pair].length
        # Nanoseconds: the sum of a path's steps depends on their order, that is on its end, in the
        # last bits.
        return round(length * self.world.grid.resolution_m / speed_m_s, 9)

    def _layer(self, number: int) -> Layer:
        layer = self._layers.get(number)
        if layer is None:
            robot_class = self._classes[number]
            blockades = tuple(self.world.blockades[name] for name in sorted(self.world.blockades))
            layer = Layer(
                self._places,
                robot_class.traversability(self.world.grid, blockades, self.parameters),
                blockades,
                snap_limit_cells=1.5 * robot_class.radius_m / self.world.grid.resolution_m + 3.0,
                any_angle=self.parameters.any_angle,
            )
            self._layers[number] = layer
        return layer

    def _count(self, layer: Layer, pairs: Iterable[Pair]) -> None:
        before = (layer.grown, layer.repaired, layer.cells_repaired)
        layer.compute(pairs)
        self.statistics.fields += layer.grown - before[0]
        self.statistics.repaired += layer.repaired - before[1]
        self.statistics.cells_repaired += layer.cells_repaired - before[2]

    def _take_over(self, number: int, old: Layer, before: GridMap) -> None:
        """Fills a layer with what the change of the map cannot touch."""
        new, robot_class = self._layer(number), self._classes[number]
        change = MapChange.between(
            (old.traversability, old.blockades, robot_class.multiplier(before, self.parameters)),
            (
                new.traversability,
                new.blockades,
                robot_class.multiplier(self.world.grid, self.parameters),
            ),
        )
        numbers = {place: index for index, place in enumerate(self._places)}
        renumbered = [numbers.get(place) for place in old.places]
        legs = {
            (first, second): leg
            for pair, leg in old.legs.items()
            if (first := renumbered[pair[0]]) is not None
            and (second := renumbered[pair[1]]) is not None
        }
        if change is None:
            new.fields, new.stale = OrderedDict(old.fields), OrderedDict(old.stale)
            new.lines = OrderedDict(old.lines)
            new.roomy = old.roomy
        else:
            here = set(new.blockades)
            new.stale = OrderedDict(
                (key, tree)
                for key, tree in [*old.stale.items(), *old.fields.items()]
                if key[1] is None or key[1] in here
            )
            touched = change.touches(
                [(self._places[i].cell, self._places[j].cell, leg) for (i, j), leg in legs.items()],
                new.snap_limit_cells,
                any_angle=self.parameters.any_angle,
            )
            self.statistics.forgotten += int(touched.sum())
            legs = {
                pair: leg for (pair, leg), hit in zip(legs.items(), touched, strict=True) if not hit
            }
        self.statistics.kept += len(legs)
        new.legs = legs
