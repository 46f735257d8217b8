"""What is left of the plan in force, and what it says the robots do next."""

from collections.abc import Sequence
from dataclasses import dataclass

import planner
from domains.formulation import Assignment, Formulation, Order, OrderKind
from domains.mission_state import MissionState
from domains.naming import Names
from service.messages.plan import PlanStep
from service.messages.report import Command


@dataclass(frozen=True)
class Remainder:
    """The steps of a plan that are not carried out yet."""

    plan: planner.Plan
    """Starts count from now; those of steps under way or late are negative."""
    names: Names
    """The names that its steps are written in."""
    orders: tuple[tuple[planner.Step, tuple[Order, ...]], ...]

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
    left: list[tuple[planner.Step, tuple[Order, ...]]] = []
    for step in sorted(steps, key=lambda step: step.start_s):
        arguments = tuple(names.name(argument) for argument in step.arguments)
        native = planner.Step(step.start_s - state.time_s, step.action, arguments, step.duration_s)
        left.append((native, tuple(formulation.orders(native, names))))
    for command in done:
        left = _without(left, command)
    return Remainder(planner.Plan(tuple(step for step, _ in left)), names, tuple(left))


def _without(
    left: list[tuple[planner.Step, tuple[Order, ...]]], command: Command
) -> list[tuple[planner.Step, tuple[Order, ...]]]:
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
