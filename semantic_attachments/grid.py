"""Attachments that the grid answers: travel, clearing, docking (Wurm, sections 3.4.1, 3.5.1).

```
(:modules
  (pathCost ?r - robot ?s - location ?g - location cost pathCost@libgrid.so)
  (exploreCost ?r - robot ?s - location ?g - location cost exploreCost@libgrid.so)
  (clearCost ?r - robot ?b - blockade cost clearCost@libgrid.so)
  (dockCost ?e - rover ?c - carrier cost dockCost@libgrid.so)
  (undockCost ?e - rover ?c - carrier cost undockCost@libgrid.so))
```

Values are seconds; infinite means that there is no way.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

from semantic_attachments.contract import Attachment, EvaluationError, Evaluator, Memory, Parameter
from semantic_attachments.path_costs import PathCosts
from semantic_attachments.world import RobotModel, World


def path_costs(world: World, memory: Memory) -> PathCosts:
    """The path costs of a world, taking over from the memory what the change left valid."""
    kept = memory.get("grid", PathCosts)
    if kept is not None and kept.world is world:
        return kept
    costs = PathCosts(world) if kept is None else kept.after(world)
    memory.keep("grid", costs)
    return costs


@dataclass(frozen=True, slots=True)
class Single:
    """An evaluator whose batch form is the single form again and again."""

    function: Callable[..., float]

    def __call__(self, *arguments: str) -> float:
        return self.function(*arguments)

    def many(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
        return [self.function(*call) for call in calls]


class ExploreCosts:
    """Travel time, and the time that exploring what lies behind the goal is expected to take.

    A robot sees as far to its left as to its right: it sweeps a strip of twice its sensor's range
    at the speed it drives with.
    """

    def __init__(self, world: World, travel: PathCosts) -> None:
        self._travel = travel
        self._unknown_m2 = {
            name: max(location.unknown_m2, 0.0) for name, location in world.locations.items()
        }
        self._sweeps_m2_s = {
            name: max(2.0 * model.sensor_range_m * model.speed_m_s, 1e-9)
            for name, model in world.robots.items()
        }

    def __call__(self, *arguments: str) -> float:
        return self.many([arguments])[0]

    def many(self, calls: Sequence[tuple[str, ...]]) -> list[float]:
        """Times [s] of many (robot, from, to), in their order."""
        unknown_m2, sweeps_m2_s = self._unknown_m2, self._sweeps_m2_s
        return [
            time_s + unknown_m2[call[2]] / sweeps_m2_s[call[0]]
            for call, time_s in zip(calls, self._travel.many(calls), strict=True)
        ]


def _explore_cost(world: World, memory: Memory) -> Evaluator:
    return ExploreCosts(world, path_costs(world, memory))


def _robot(world: World, name: str) -> RobotModel:
    model = world.robots.get(name)
    if model is None:
        raise EvaluationError(f"the world has no robot {name!r}")
    return model


def _clear_cost(world: World, _: Memory) -> Evaluator:
    def clear_cost(robot: str, blockade: str) -> float:
        model = _robot(world, robot)
        location = world.locations.get(blockade)
        known = world.blockades.get(blockade if location is None else location.blockade or blockade)
        if known is None:
            return inf
        return known.clear_duration_s / model.clear_speed_factor

    return Single(clear_cost)


def _dock_cost(world: World, _: Memory) -> Evaluator:
    return Single(lambda rover, _carrier: _robot(world, rover).dock_duration_s)


def _undock_cost(world: World, _: Memory) -> Evaluator:
    return Single(lambda rover, _carrier: _robot(world, rover).undock_duration_s)


_WAY = (Parameter("robot", "robot"), Parameter("from", "location"), Parameter("to", "location"))
_ROVER_AND_CARRIER = (Parameter("rover", "robot"), Parameter("carrier", "robot"))

ATTACHMENTS = (
    Attachment(
        name="pathCost",
        parameters=_WAY,
        bind=path_costs,
        thread_safe=True,
        quick=True,
    ),
    Attachment(
        name="exploreCost",
        parameters=_WAY,
        bind=_explore_cost,
        thread_safe=True,
        quick=True,
    ),
    Attachment(
        name="clearCost",
        parameters=(Parameter("robot", "robot"), Parameter("blockade", "blockade")),
        bind=_clear_cost,
        thread_safe=True,
        quick=True,
    ),
    Attachment(
        name="dockCost",
        parameters=_ROVER_AND_CARRIER,
        bind=_dock_cost,
        thread_safe=True,
        quick=True,
    ),
    Attachment(
        name="undockCost",
        parameters=_ROVER_AND_CARRIER,
        bind=_undock_cost,
        thread_safe=True,
        quick=True,
    ),
)
