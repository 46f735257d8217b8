"""Attachment `motionCost`: durations by motion planning with OMPL for robots that are no discs.

```
(:modules (motionCost ?r - robot ?s - location ?g - location cost motionCost@libmotion.so))
```

As for `pathCost`, every known blockade is a wall save those at both ends of the way (Wurm, section
3.5.1). A robot starts and arrives with the heading that suits it best. Motions are found by
sampling: they exist, but quicker ones may, too.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from math import hypot, inf
from threading import RLock
from time import monotonic

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.contract import Attachment, EvaluationError, Memory, Parameter, Quality
from semantic_attachments.motion_change import Box, changed_cells, touches
from semantic_attachments.motion_parameters import MotionParameters
from semantic_attachments.motion_worker import MotionWorker, Query
from semantic_attachments.outline import inner_radius_m
from semantic_attachments.path_costs import PathCosts
from semantic_attachments.robot_class import GridParameters
from semantic_attachments.robot_model import RobotModel
from semantic_attachments.world import Blockade, Location, World

Call = tuple[str, ...]
Key = tuple[RobotModel, Location, Location]

_STEPS_OVER_LINES = 1.1
"""A path of eight steps is at most 1.0824 times as long as the line it follows."""

_START_UP_S = 30.0
"""Time a worker may take before it plans: to start, and to build a roadmap [s]."""


class MotionWorkers:
    """The worker processes of a mission, one a robot model."""

    def __init__(self, parameters: MotionParameters) -> None:
        self.parameters = parameters
        self._workers: dict[RobotModel, MotionWorker] = {}

    def of(self, model: RobotModel) -> MotionWorker:
        """The model's worker; a new one if it ended."""
        worker = self._workers.get(model)
        if worker is None or not worker.alive:
            worker = self._workers[model] = MotionWorker(model, self.parameters)
        return worker

    def close(self) -> None:
        """Ends all processes; they also end with the object."""
        for worker in self._workers.values():
            worker.close()
        self._workers.clear()


class MotionCosts:
    """Evaluator of `motionCost(robot, from, to)` in seconds."""

    def __init__(self, world: World, workers: MotionWorkers) -> None:
        self.world = world
        self.workers = workers
        """The processes that plan."""
        self.kept = 0
        """Durations taken over from the world before."""
        self._durations_s: dict[Key, float] = {}
        self._lock = RLock()

    def after(self, world: World) -> "MotionCosts":
        """The motion costs of a changed world, with every duration that the change cannot touch."""
        costs = MotionCosts(world, self.workers)
        cells = changed_cells(self.world.grid, world.grid)
        if cells is None:
            return costs
        models, places = set(world.robots.values()), set(world.locations.values())
        with self._lock:
            for (model, start, goal), duration_s in self._durations_s.items():
                if model not in models or start not in places or goal not in places:
                    continue
                before, now = set(self._closed(start, goal)), set(costs._closed(start, goal))
                if duration_s == inf:
                    is_kept = not cells and before <= now
                else:
                    changed = [*cells, *(Box.around(blockade) for blockade in before ^ now)]
                    ends_m = (start.position_m, goal.position_m)
                    # A place too near to an obstacle is left and reached from beside it.
                    reach_m = 2 * self._beside_m(model)
                    length_m = duration_s * model.speed_m_s
                    is_kept = not touches(changed, ends_m, length_m, reach_m)
                if is_kept:
                    costs._durations_s[model, start, goal] = duration_s
        costs.kept = len(costs._durations_s)
        return costs

    def __call__(self, *arguments: str) -> float:
        """Duration [s] of (robot, from, to); infinite if no motion was found."""
        return self.many([arguments])[0]

    def many(self, calls: Sequence[Call]) -> list[float]:
        """Durations [s] of many (robot, from, to), in their order.

        Raises:
            EvaluationError: if the world has no such robot or location, or a worker fails.
        """
        with self._lock:
            keys = [self._resolve(call) for call in calls]
            missing = {k: c for k, c in zip(keys, calls, strict=True) if k not in self._durations_s}
            bounds_s = self.lower_bounds(list(missing.values()))
            self._durations_s.update(
                (key, inf) for key, bound_s in zip(missing, bounds_s, strict=True) if bound_s == inf
            )
            self._plan([key for key in missing if key not in self._durations_s])
            return [self._durations_s[key] for key in keys]

    def lower_bounds(self, calls: Sequence[Call]) -> list[float]:
        """What no motion is quicker than, without planning motions [s].

        The longer of the straight line and the grid path of the disc inside the outline, less what
        its steps and cells may add; infinite if that disc does not get through.
        """
        with self._lock:
            on_grid_s = self._inner_costs.many(calls)
        bounds = []
        for (model, start, goal), grid_s in zip(map(self._resolve, calls), on_grid_s, strict=True):
            (x0, y0), (x1, y1) = start.position_m, goal.position_m
            # A place too near to an obstacle is left and reached from beside it.
            beside_s = 2 * self._beside_m(model) / model.speed_m_s
            straight_s = hypot(x1 - x0, y1 - y0) / model.speed_m_s
            bound_s = max(straight_s, grid_s / _STEPS_OVER_LINES) - beside_s
            bounds.append(max(bound_s, 0.0))
        return bounds

    def path(self, robot: str, start: str, goal: str) -> NDArray[np.float64]:
        """(n, 3) poses x [m], y [m], heading [rad] from one location to another, at most half a
        cell apart."""
        with self._lock:
            model, first, last = self._resolve((robot, start, goal))
            if self.many([(robot, start, goal)])[0] == inf:
                return np.empty((0, 3))
            if first == last:
                return np.array([[*first.position_m, 0.0]])
            closed = self._closed(first, last)
            query = Query(first.position_m, (last.position_m,), closed, whole=True)
            worker = self.workers.of(model)
            worker.ask(self.world.grid, [query])
            ((motion,),) = worker.answer(monotonic() + self._patience_s(1))
            poses: NDArray[np.float64] = motion.poses
            return poses

    @cached_property
    def _inner_costs(self) -> PathCosts:
        """Path costs of the discs inside the outlines, smaller by what cells may hide."""
        hidden_m = 1.5 * self.world.grid.resolution_m
        discs = {
            name: replace(
                model,
                radius_m=max(inner_radius_m(model) - hidden_m, 0.0),
                terrain_speed_m_s={},
            )
            for name, model in self.world.robots.items()
        }
        parameters = GridParameters(unknown_is_free=self.workers.parameters.unknown_is_free)
        return PathCosts(replace(self.world, robots=discs), parameters)

    def _beside_m(self, model: RobotModel) -> float:
        outer_m = max((hypot(x, y) for x, y in model.footprint_m), default=model.radius_m)
        return 1.5 * outer_m + 4 * self.world.grid.resolution_m

    def _resolve(self, call: Call) -> Key:
        if len(call) != 3:
            raise EvaluationError(f"motionCost takes a robot and two locations, not {call}")
        robot, start, goal = call
        if robot not in self.world.robots:
            raise EvaluationError(f"the world has no robot {robot!r}")
        for name in (start, goal):
            if name not in self.world.locations:
                raise EvaluationError(f"the world has no location {name!r}")
        locations = self.world.locations
        return self.world.robots[robot], locations[start], locations[goal]

    def _plan(self, keys: Sequence[Key]) -> None:
        grid = self.world.grid
        questions: dict[
            RobotModel, dict[tuple[Location, tuple[Blockade, ...]], list[Location]]
        ] = {}
        for key in keys:
            model, start, goal = key
            ends = (start.position_m, goal.position_m)
            if start == goal:
                self._durations_s[key] = 0.0
            elif any(grid.cell_at(position_m) is None for position_m in ends):
                self._durations_s[key] = inf
            else:
                by_start = questions.setdefault(model, {})
                by_start.setdefault((start, self._closed(start, goal)), []).append(goal)
        for model, by_start in questions.items():
            queries = [
                Query(start.position_m, tuple(goal.position_m for goal in goals), closed)
                for (start, closed), goals in by_start.items()
            ]
            self.workers.of(model).ask(grid, queries)
        for model, by_start in questions.items():
            pairs = sum(len(goals) for goals in by_start.values())
            answers = self.workers.of(model).answer(monotonic() + self._patience_s(pairs))
            for (start, _), goals, found in zip(by_start, by_start.values(), answers, strict=True):
                for goal, duration_s in zip(goals, found, strict=True):
                    self._durations_s[model, start, goal] = duration_s

    def _patience_s(self, pairs: int) -> float:
        """How long a worker may take for some pairs."""
        parameters = self.workers.parameters
        return _START_UP_S + pairs * (parameters.budget_s + parameters.improvement_s + 1.0)

    def _closed(self, start: Location, goal: Location) -> tuple[Blockade, ...]:
        opened = {start.blockade, goal.blockade}
        names = sorted(self.world.blockades)
        return tuple(self.world.blockades[name] for name in names if name not in opened)


def motion_costs(
    world: World, memory: Memory, parameters: MotionParameters | None = None
) -> MotionCosts:
    """The motion costs of a world; durations that its change cannot touch, worker processes and
    their roadmaps live on in the memory."""
    parameters = parameters or MotionParameters()
    workers = memory.get("motion", MotionWorkers)
    if workers is None or workers.parameters != parameters:
        workers = MotionWorkers(parameters)
        memory.keep("motion", workers)
    kept = memory.get("motion costs", MotionCosts)
    if kept is None or kept.workers is not workers:
        costs = MotionCosts(world, workers)
    else:
        costs = kept if kept.world is world else kept.after(world)
    memory.keep("motion costs", costs)
    return costs


ATTACHMENTS = (
    Attachment(
        name="motionCost",
        parameters=(
            Parameter("robot", "robot"),
            Parameter("from", "location"),
            Parameter("to", "location"),
        ),
        bind=motion_costs,
        quality=Quality.APPROXIMATE,
        thread_safe=True,
    ),
)
