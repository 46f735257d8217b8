"""Power constraints (Wurm, section 3.8): enough charge for the way, and from there to a charger.

```
(:modules
  (pathCost ?r - robot ?s - location ?g - location cost pathCost@libgrid.so)
  (enoughCharge ?r - robot ?s - location ?g - location conditionchecker enoughCharge@libbattery.so)
  (drain ?r - robot ?s - location ?g - location (charge ?r) effect drain@libbattery.so))
(:functions (charge ?r - robot) ...)
(:durative-action move ...
  :condition (and ... (at start ([enoughCharge ?r ?s ?g])))
  :effect (and ... (at start ([drain ?r ?s ?g]))))
```

`(charge ?r)` is the time [s] that a robot can drive with what is in its battery. Chargers are the
locations with `Location.charger`; they are reached from the goal as `pathCost` says.
"""

from collections.abc import Sequence
from math import inf

from semantic_attachments.contract import (
    Attachment,
    EvaluationError,
    Kind,
    Memory,
    Parameter,
    Purity,
    StateView,
)
from semantic_attachments.grid import path_costs
from semantic_attachments.path_costs import PathCosts
from semantic_attachments.world import World

Call = tuple[str, ...]


class EnoughCharge:
    """Evaluator of `enoughCharge(robot, from, to)`: can it drive there and on to a charger?"""

    def __init__(self, world: World, costs: PathCosts) -> None:
        self._costs = costs
        self._chargers = [name for name, place in sorted(world.locations.items()) if place.charger]

    def __call__(self, state: StateView, *call: str) -> bool:
        return self.many([call], state)[0]

    def many(self, calls: Sequence[Call], state: StateView) -> list[bool]:
        ways_s = self._costs.many(calls)
        ways_on_s = self._costs.many(
            [(robot, goal, charger) for robot, _, goal in calls for charger in self._chargers]
        )
        count = len(self._chargers)
        nearest_s = [
            min(ways_on_s[i * count : (i + 1) * count], default=inf) for i in range(len(calls))
        ]
        return [
            way_s + on_s <= _charge_s(state, call[0])
            for call, way_s, on_s in zip(calls, ways_s, nearest_s, strict=True)
        ]


class Drain:
    """Effect `drain(robot, from, to)`: the charge left after the way."""

    def __init__(self, costs: PathCosts) -> None:
        self._costs = costs

    def __call__(self, state: StateView, *call: str) -> list[float] | None:
        left_s = _charge_s(state, call[0]) - self._costs(*call)
        return [left_s] if left_s >= 0 else None


def _charge_s(state: StateView, robot: str) -> float:
    charge_s = state.value("charge", robot)
    if charge_s is None:
        raise EvaluationError(f"(charge {robot}) has no value; give it one in :init")
    return charge_s


def _enough_charge(world: World, memory: Memory) -> EnoughCharge:
    return EnoughCharge(world, path_costs(world, memory))


def _drain(world: World, memory: Memory) -> Drain:
    return Drain(path_costs(world, memory))


_WAY = (
    Parameter("robot", "robot"),
    Parameter("from", "location"),
    Parameter("to", "location"),
)

ATTACHMENTS = (
    Attachment(
        name="enoughCharge",
        parameters=_WAY,
        bind=_enough_charge,
        kind=Kind.CONDITION,
        purity=Purity.FLUENTS,
        reads=(("charge", "robot"),),
        thread_safe=True,
    ),
    Attachment(
        name="drain",
        parameters=_WAY,
        bind=_drain,
        kind=Kind.EFFECT,
        purity=Purity.FLUENTS,
        reads=(("charge", "robot"),),
        thread_safe=True,
    ),
)
