"""Travel times between named places (Wurm, sections 3.4.1 and 3.5.1): `C(x, t)` of each robot.

Every known blockade is a wall, save the one that a robot starts from or goes to. Costs do not
depend on the direction of travel, so each pair of places is computed once, from whichever end
serves more pairs.

What is kept across replans is the pairs: a pair is forgotten only if a cell of its path was closed,
or if opened cells lie where a shorter path could run (no octile path through them is longer).
"""

from collections import OrderedDict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from threading import RLock

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.contract import EvaluationError
from semantic_attachments.legs import Layer, Pair, Place, ordered
from semantic_attachments.map_change import MapChange
from semantic_attachments.robot_class import GridParameters, RobotClass, fastest_m_s
from semantic_attachments.world import GridMap, Location, World


@dataclass(slots=True)
class Statistics:
    """Counts of the work done."""

    fields: int = 0
    """One-to-all searches."""
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
        self._layers: dict[RobotClass, Layer] = {}
        self._lock = RLock()
        self._classes = {
            name: (RobotClass.of(model, world.grid, self.parameters), fastest_m_s(model))
            for name, model in world.robots.items()
        }
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
                    wanted.setdefault(robot_class, {})[ordered(start, goal)] = None
            for robot_class, pairs in wanted.items():
                layer = self._layer(robot_class)
                self._count(layer, pairs)
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
            pair = ordered(first, last)
            self._count(layer, [pair])
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
        return self(robot, start, goal) * self._classes[robot][1]

    def _resolve(
        self, call: tuple[str, ...]
    ) -> tuple[RobotClass, float, Place | None, Place | None]:
        if len(call) != 3:
            raise EvaluationError(f"pathCost takes a robot and two locations, not {call}")
        robot, start, goal = call
        if robot not in self._classes:
            raise EvaluationError(f"the world has no robot {robot!r}")
        for name in (start, goal):
            if name not in self._places:
                raise EvaluationError(f"the world has no location {name!r}")
        return *self._classes[robot], self._places[start], self._places[goal]

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
        length = self._layers[robot_class].legs[ordered(start, goal)].length
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
                any_angle=self.parameters.any_angle,
            )
            self._layers[robot_class] = layer
        return layer

    def _count(self, layer: Layer, pairs: Iterable[Pair]) -> None:
        before = layer.grown
        layer.compute(pairs)
        self.statistics.fields += layer.grown - before

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
            new.lines = OrderedDict(old.lines)
            new.roomy = old.roomy
        places = {place for place in self._places.values() if place is not None}
        legs = {
            pair: leg for pair, leg in old.legs.items() if pair[0] in places and pair[1] in places
        }
        if change is not None:
            touched = change.touches(
                [(pair[0].cell, pair[1].cell, leg) for pair, leg in legs.items()],
                new.snap_limit_cells,
                any_angle=self.parameters.any_angle,
            )
            self.statistics.forgotten += int(touched.sum())
            legs = {
                pair: leg for (pair, leg), hit in zip(legs.items(), touched, strict=True) if not hit
            }
        self.statistics.kept += len(legs)
        new.legs = legs
        return new
