"""The plan in force brought up to date with targets that have come and gone.

In an exploration the frontier in front of a robot moves on as it looks around: what replaces a
target that is gone stands close to where it was. A plan that is thrown away whenever that happens
is never carried out; one that is revised is the start that the next search improves on.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import dist, inf, isfinite

import planner
from domains.formulation import Formulation, Order, OrderKind, PathCost, asked
from domains.mission_state import Activity, MissionState
from domains.naming import Names
from service.messages.base import Position
from service.messages.plan import PlanStep

SUCCESSOR_WITHIN_M = 6.0
"""A new target this near to one that is gone takes its place in the plan."""


@dataclass(frozen=True)
class Revision:
    """A plan whose targets are all there."""

    steps: tuple[PlanStep, ...]
    successors: Mapping[str, str] = field(default_factory=dict)
    """What takes the place of targets that are gone."""
    gone: frozenset[str] = frozenset()
    """Targets that were left out without a successor."""


def revised(
    steps: Sequence[PlanStep],
    done: Collection[str],
    state: MissionState,
    places_m: Mapping[str, Position],
) -> Revision:
    """Steps that name targets which are gone name their successors instead, or are left out.

    Args:
        done: places that commands have been carried out at since the plan came into force.
        places_m: where the targets that the plan knows were last.
    """
    open_m = {target.id: target.position_m for target in state.targets}
    named = {argument for step in steps for argument in step.arguments}
    gone = {name for name in named & places_m.keys() if name not in open_m and name not in done}
    if not gone:
        return Revision(tuple(steps))
    successors = _successors(gone, places_m, {n: p for n, p in open_m.items() if n not in named})
    gone -= successors.keys()
    renamed = [
        step.model_copy(update={"arguments": [successors.get(one, one) for one in step.arguments]})
        for step in steps
    ]
    return Revision(without_visits(renamed, gone), successors, frozenset(gone))


def without_visits(steps: Sequence[PlanStep], left_out: Collection[str]) -> tuple[PlanStep, ...]:
    """Steps by start, without those that lead to some targets; robots go on from where they were
    before."""
    kept: list[PlanStep] = []
    stayed: dict[tuple[str, str], str] = {}
    """Where a robot is instead of at a target that was left out."""
    for step in sorted(steps, key=lambda step: step.start_s):
        arguments = list(step.arguments)
        if len(arguments) == 3 and arguments[1] in left_out:
            arguments[1] = stayed.get((arguments[0], arguments[1]), arguments[1])
        if len(arguments) == 3 and arguments[2] in left_out:
            stayed[arguments[0], arguments[2]] = arguments[1]
            continue
        kept.append(step.model_copy(update={"arguments": arguments}))
    return tuple(kept)


def _successors(
    gone: Collection[str], places_m: Mapping[str, Position], new_m: Mapping[str, Position]
) -> dict[str, str]:
    """The new target that takes the place of each that is gone, the nearest pairs first."""
    pairs = sorted(
        (apart_m, old, new)
        for old in gone
        for new, position_m in new_m.items()
        if (apart_m := dist(places_m[old], position_m)) <= SUCCESSOR_WITHIN_M
    )
    chosen: dict[str, str] = {}
    for _, old, new in pairs:
        if old not in chosen and new not in chosen.values():
            chosen[old] = new
    return chosen


@dataclass(slots=True)
class _Stop:
    """A place on a robot's way, and the step that brings it there."""

    place: str
    step: planner.Step | None
    onward: bool
    """Whether another stop can be made before the next one."""


def with_new_targets(
    plan: planner.Plan,
    goals: Collection[str],
    state: MissionState,
    formulation: Formulation,
    cost: PathCost,
) -> planner.Plan:
    """A plan in which every new goal that a robot can get to on its way is a stop on that way.

    Cheapest insertion: each goal goes where it makes a robot's way longer by the least
    (Rosenkrantz, Stearns and Lewis, "An Analysis of Several Heuristics for the Traveling Salesman
    Problem", SIAM J. Computing 6, 1977). Times are left to whoever schedules the plan; only the
    order counts.
    """
    names = formulation.names(state)
    visited = {
        order.location
        for step in plan
        for order in formulation.orders(step, names)
        if order.kind is OrderKind.EXPLORE
    }
    missing = sorted(set(goals) - visited)
    ways = _ways(plan, state, formulation, names)
    while missing:
        calls = [
            (names.name(robot), start, end)
            for robot, stops in ways.items()
            for goal in missing
            for start, end in _legs(stops, names.name(goal))
        ]
        times_s = asked(cost, list(dict.fromkeys(calls)))
        best: tuple[float, str, str, int] = (inf, "", "", 0)
        for robot, stops in ways.items():
            for goal in missing:
                for index, extra_s in _detours(names.name(robot), stops, names.name(goal), times_s):
                    best = min(best, (extra_s, goal, robot, index))
        if not isfinite(best[0]):
            break
        _, goal, robot, index = best
        missing.remove(goal)
        if (action := formulation.visit(robot, names.id(ways[robot][index].place), goal)) is None:
            break
        _insert(ways[robot], index, action[0], tuple(names.name(one) for one in action[1]))
    steps = {id(stop.step): stop.step for stops in ways.values() for stop in stops if stop.step}
    return planner.Plan(tuple(sorted(steps.values(), key=lambda step: step.start)))


def _ways(
    plan: planner.Plan, state: MissionState, formulation: Formulation, names: Names
) -> dict[str, list[_Stop]]:
    """Where each robot that takes part is during the plan, in order."""
    ways: dict[str, list[_Stop]] = {}
    for robot in state.robots:
        if robot.activity is Activity.FREE:
            here = names.name(formulation.standing(robot, state))
            ways[robot.id] = [_Stop(here, None, onward=True)]
        else:
            ways[robot.id] = []
    for step in sorted(plan, key=lambda step: step.start):
        for order in formulation.orders(step, names):
            stops = ways.setdefault(order.robot, [])
            drives = order.kind in (OrderKind.MOVE, OrderKind.EXPLORE)
            if stops:
                # Between two drives a robot can stop elsewhere; it docks and clears where it is.
                stops[-1].onward = drives
                if drives:
                    stops[-1].place = step.arguments[1]
            place = names.name(order.location)
            stops.append(_Stop(place, step, onward=not _is_last(order, state)))
    return ways


def _is_last(order: Order, state: MissionState) -> bool:
    """Whether the robot goes nowhere by itself after this: it is aboard."""
    riders = {robot.id for robot in state.robots if robot.id not in state.capacities}
    return order.kind is OrderKind.DOCK and order.robot in riders


def _legs(stops: Sequence[_Stop], goal: str) -> list[tuple[str, str]]:
    """The ways that have to be known to make a stop at a goal."""
    legs = []
    for index, stop in enumerate(stops):
        if stop.onward and stop.place != goal:
            legs.append((stop.place, goal))
            if index + 1 < len(stops) and goal != stops[index + 1].place:
                legs += [(goal, stops[index + 1].place), (stop.place, stops[index + 1].place)]
    return legs


def _detours(
    robot: str, stops: Sequence[_Stop], goal: str, times_s: Mapping[tuple[str, str, str], float]
) -> list[tuple[int, float]]:
    """After which stop, and by how much longer [s], a robot's way could lead to a goal."""
    found = []
    for index, stop in enumerate(stops):
        there_s = times_s.get((robot, stop.place, goal), inf)
        if not stop.onward or not isfinite(there_s):
            continue
        if index + 1 == len(stops):
            found.append((index, there_s))
            continue
        following = stops[index + 1].place
        onward_s = times_s.get((robot, goal, following), inf)
        direct_s = times_s.get((robot, stop.place, following), 0.0)
        found.append((index, there_s + onward_s - direct_s))
    return found


def _insert(stops: list[_Stop], index: int, action: str, arguments: tuple[str, ...]) -> None:
    """Makes a stop, with an action that ends there, after the one with that index."""
    before, place = stops[index].step, arguments[-1]
    start_s = 0.0 if before is None else before.end
    if index + 1 < len(stops) and (following := stops[index + 1].step) is not None:
        onward = (following.arguments[0], place, *following.arguments[2:])
        stops[index + 1].step = replace(following, arguments=onward)
        start_s = following.start
    step = planner.Step(start_s, action, arguments, None)
    stops.insert(index + 1, _Stop(place, step, onward=True))
