"""The world of a PDDL problem: its static numeric fluents carry the geometry, a map the rest.

| fluents | meaning, in the map frame |
|---|---|
| `(x l)`, `(y l)` | position of a location [m] |
| `(x-from b)`, `(y-from b)`, `(x-to b)`, `(y-to b)` | ends of a blockade [m]; it is a location, too
| | `(clear-duration b)` | time that clearing it takes [s] |
| `(speed r)`, `(radius r)` | a robot's speed [m/s] and radius [m] |
| `(capacity r)` | rovers it can carry |
| the fact `(charger l)` | batteries can be charged there |
"""

from collections.abc import Mapping, Sequence, Set
from dataclasses import replace
from typing import Protocol

from semantic_attachments.grid_map import GridMap
from semantic_attachments.world import Blockade, Location, RobotModel, World

Fluents = Mapping[tuple[str, ...], float]
"""Initial values of numeric fluents by name and arguments: `{("x", "target_1"): 4.5}`."""

_SEGMENT = ("x-from", "y-from", "x-to", "y-to")


class ProblemView(Protocol):
    """What a world is built from of a problem."""

    @property
    def objects(self) -> Mapping[str, Sequence[str]]:
        """Types of each object."""

    @property
    def fluents(self) -> Fluents:
        """Initial values of numeric fluents."""

    @property
    def facts(self) -> Set[tuple[str, ...]]:
        """Facts true at time 0."""


def world_of_problem(
    problem: ProblemView,
    grid: GridMap,
    robot_types: Mapping[str, RobotModel] | None = None,
) -> World:
    """The world that the attachments of a problem see.

    Args:
        robot_types: what fluents cannot say (terrain classes), by the PDDL type of the robots; a
        robot's
            own fluents win over it.

    Raises:
        ValueError: naming the object that lacks a fluent, and the fluent.
    """
    fluents = problem.fluents
    locations, blockades, robots = {}, {}, {}
    types = robot_types or {}
    for name, type_names in problem.objects.items():
        known = [types[type_name] for type_name in type_names if type_name in types]
        charger = ("charger", name) in problem.facts
        if any((fluent, name) in fluents for fluent in _SEGMENT):
            ends = [_value(fluents, fluent, name) for fluent in _SEGMENT]
            blockades[name] = Blockade(
                id=name,
                segment_m=((ends[0], ends[1]), (ends[2], ends[3])),
                clear_duration_s=fluents.get(("clear-duration", name), 0.0),
            )
            centre_m = blockades[name].centre_m
            locations[name] = Location(
                position_m=(
                    fluents.get(("x", name), centre_m[0]),
                    fluents.get(("y", name), centre_m[1]),
                ),
                blockade=name,
            )
        elif ("x", name) in fluents or ("y", name) in fluents:
            position_m = (_value(fluents, "x", name), _value(fluents, "y", name))
            locations[name] = Location(position_m=position_m, charger=charger)
        elif ("speed", name) in fluents or known:
            robots[name] = _robot(fluents, name, " ".join(type_names), known[0] if known else None)
    return World(grid=grid, locations=locations, robots=robots, blockades=blockades)


def _robot(fluents: Fluents, name: str, type_name: str, model: RobotModel | None) -> RobotModel:
    if model is None:
        model = RobotModel(type_name, radius_m=0.0, speed_m_s=_value(fluents, "speed", name))
    return replace(
        model,
        speed_m_s=fluents.get(("speed", name), model.speed_m_s),
        radius_m=fluents.get(("radius", name), model.radius_m),
        capacity=int(fluents.get(("capacity", name), model.capacity)),
    )


def _value(fluents: Fluents, fluent: str, name: str) -> float:
    value = fluents.get((fluent, name))
    if value is None:
        raise ValueError(
            f"the problem gives no initial value for ({fluent} {name}); "
            f"add (= ({fluent} {name}) ...) to :init"
        )
    return value
