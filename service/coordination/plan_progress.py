"""What is left of the plan in force, and what it says the robots do next."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import planner
from domains.formulation import Assignment, Formulation, Order, OrderKind
from domains.mission_state import Activity, MissionState
from domains.naming import Names
from service.messages.plan import PlanStep
from service.messages.report import Command

WAIT_MARGIN_S = 0.5
"""A step that starts later than this after its robots' last ones waits for somebody else."""

Entry: TypeAlias = tuple[planner.Step, tuple[Order, ...]]
"""A step and what it means for its robots."""


@dataclass(frozen=True)
class Remainder:
    """The steps of a plan that are not carried out yet."""

    plan: planner.Plan
    """Starts count from now; those of steps under way or late are negative."""
    names: Names
    """The names that its steps are written in."""
    orders: tuple[Entry, ...]

    def assignments(self, formulation: Formulation, state: MissionState) -> tuple[Assignment, ...]:
        """What each free robot does next."""
        return formulation.assignments(self.plan, state, self.names)

    def ends_s(self) -> dict[tuple[str, str], float]:
        """When each visit of a target ends, from now [s], by robot and target."""
        return {
            (order.robot, order.location): step.end
            for step, orders in self.orders
            for order in orders
            if order.kind is OrderKind.EXPLORE
        }


def remainder(
    formulation: Formulation,
    state: MissionState,
    steps: Sequence[PlanStep],
    done: Sequence[Command],
) -> Remainder:
    """What is left of a plan after the commands in `done`, in the order they were carried out.

    A step is done when the first of its robots reports so. Movements of a robot before a step that
    it has done are done too: a robot that stands where it should move to gets no command for it.
    """
    names = Names(dict.fromkeys(argument for step in steps for argument in step.arguments))
    left: list[Entry] = []
    for step in sorted(steps, key=lambda step: step.start_s):
        arguments = tuple(names.name(argument) for argument in step.arguments)
        native = planner.Step(step.start_s - state.time_s, step.action, arguments, step.duration_s)
        left.append((native, tuple(formulation.orders(native, names))))
    waiting = _waiting(left)
    for command in done:
        left = _without(left, command)
    known = formulation.names(state)
    left = [
        (step, orders)
        for step, orders in left
        # A blockade that was cleared is no place to go to any more: what comes next starts at once.
        if not all(o.kind is OrderKind.MOVE and o.location not in known for o in orders)
    ]
    left = _begun_at_once(left, waiting)
    return Remainder(planner.Plan(tuple(step for step, _ in left)), names, tuple(left))


def from_here(left: Remainder, formulation: Formulation, state: MissionState) -> planner.Plan:
    """The remainder as a start for planning anew, in the names of `state`.

    Every free robot begins its first step from where it is now, as the formulation says. What names
    something that is gone is left out.
    """
    names = formulation.names(state)
    to_depart = {robot.id: robot for robot in state.robots if robot.activity is Activity.FREE}
    steps: list[planner.Step] = []
    for step, orders in left.orders:
        ids = tuple(left.names.id(argument) for argument in step.arguments)
        departing = [to_depart.pop(order.robot, None) for order in orders]
        begun = [(step.action, ids)]
        if departing and departing[0] is not None:
            begun = list(formulation.departing(step.action, ids, departing[0], state))
        for index, (action, arguments) in enumerate(begun, 1):
            if all(one in names for one in arguments):
                # A way to the step is as long as it takes; the step itself as long as planned.
                duration_s = step.duration if index == len(begun) else None
                written = tuple(names.name(one) for one in arguments)
                steps.append(planner.Step(max(step.start, 0.0), action, written, duration_s))
    return planner.Plan(tuple(steps))


def _waiting(entries: Sequence[Entry]) -> set[planner.Step]:
    """Steps before which a robot stands still in the plan: they wait for somebody else."""
    free_s: dict[str, float] = {}
    begin_s = min((step.start for step, _ in entries), default=0.0)
    waiting = set()
    for step, orders in entries:
        ready_s = max(free_s.get(order.robot, begin_s) for order in orders)
        if step.start > ready_s + WAIT_MARGIN_S:
            waiting.add(step)
        for order in orders:
            free_s[order.robot] = step.end
    return waiting


def _begun_at_once(left: Sequence[Entry], waiting: set[planner.Step]) -> list[Entry]:
    """The remainder in which robots that are early, and wait for nobody, begin what comes next."""
    seen: set[str] = set()
    begun = []
    for step, orders in left:
        robots = {order.robot for order in orders}
        if step not in waiting and step.start > 0.0 and not robots & seen:
            begun.append((replace(step, start=0.0), orders))
        else:
            begun.append((step, orders))
        seen |= robots
    return begun


def _without(left: list[Entry], command: Command) -> list[Entry]:
    wanted = (command.robot, command.kind, command.location)
    for index, (_, orders) in enumerate(left):
        if any((o.robot, o.kind.value, o.location) == wanted for o in orders):
            before = [
                entry
                for entry in left[:index]
                if not all(o.robot == command.robot and o.kind is OrderKind.MOVE for o in entry[1])
            ]
            return before + left[index + 1 :]
    return left
