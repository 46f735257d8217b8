"""A unified-planning problem for engines that know integers only and want each to have a value.

PDDL's fluents are read as real numbers. Those that only ever hold integers become integers. Where
one has no initial value, it gets 0, and a predicate keeps actions from reading it.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product

from unified_planning.model import (
    Action,
    DurativeAction,
    Effect,
    Fluent,
    FNode,
    InstantaneousAction,
    Problem,
    StartTiming,
    TimeInterval,
    TimePointInterval,
    Timing,
)


class FractionError(Exception):
    """A number that is not an integer."""


def with_integers(problem: Problem) -> Problem:
    """The same problem over integers; raises `FractionError` where a value has a fraction.

    Metrics other than the makespan are left out: any plan of the result is one of the original.
    """
    return _Rewriter(problem).rewritten()


class _Rewriter:
    def __init__(self, problem: Problem) -> None:
        self._old = problem
        self._environment = problem.environment
        self._new = Problem(problem.name, self._environment)
        self._fluents: dict[Fluent, Fluent] = {}
        self._defined: dict[Fluent, Fluent] = {}

    def rewritten(self) -> Problem:
        old, new = self._old, self._new
        new.add_objects(old.all_objects)
        values = dict(old.explicit_initial_values)
        for fluent in old.fluents:
            self._add(fluent, values)
        for fluent, value in values.items():
            new.set_initial_value(self._over(fluent), value)
        for timing, effects in old.timed_effects.items():
            for effect in effects:
                self._timed(timing, effect)
        for action in old.actions:
            new.add_action(self._action(action))
        for goal in old.goals:
            new.add_goal(self._over(goal))
        for metric in old.quality_metrics:
            if metric.is_minimize_makespan():
                new.add_quality_metric(metric)
        return new

    def _add(self, fluent: Fluent, values: dict[FNode, FNode]) -> None:
        types = self._environment.type_manager
        if not fluent.type.is_real_type():
            self._fluents[fluent] = fluent
            self._new.add_fluent(fluent, default_initial_value=False)
            return
        own = {node: value for node, value in values.items() if node.fluent() == fluent}
        for node, value in own.items():
            if not value.is_int_constant():
                raise FractionError(f"{node} is {value}, which is not an integer")
        integer = Fluent(fluent.name, types.IntType(), fluent.signature, self._environment)
        self._fluents[fluent] = integer
        self._new.add_fluent(integer, default_initial_value=0)
        static = fluent in self._old.get_static_fluents()
        objects = [list(self._old.objects(one.type)) for one in fluent.signature]
        if not static or all(fluent(*some) in own for some in product(*objects)):
            return
        name = f"defined-{fluent.name}"
        while self._old.has_name(name):
            name += "-"
        defined = Fluent(name, types.BoolType(), fluent.signature, self._environment)
        self._defined[fluent] = defined
        self._new.add_fluent(defined, default_initial_value=False)
        for node in own:
            self._new.set_initial_value(defined(*node.args), True)

    def _over(self, expression: FNode) -> FNode:
        """The expression over the new fluents."""
        nodes = self._environment.free_vars_extractor.get(expression)
        replaced = {node: self._fluents[node.fluent()](*node.args) for node in nodes}
        return self._environment.substituter.substitute(expression, replaced)

    def _read(self, expressions: Iterable[FNode]) -> set[FNode]:
        """What has to be defined for these expressions to have values."""
        nodes = {
            node
            for expression in expressions
            for node in self._environment.free_vars_extractor.get(expression)
        }
        return {
            self._defined[node.fluent()](*node.args)
            for node in nodes
            if node.fluent() in self._defined
        }

    def _action(self, action: Action) -> Action:
        new = action.clone()
        if isinstance(action, InstantaneousAction):
            new.clear_preconditions()
            new.clear_effects()
            values = [effect.value for effect in action.effects]
            for condition in action.preconditions:
                new.add_precondition(self._over(condition))
            for effect in action.effects:
                self._effect(new, None, effect)
            for condition in self._sorted(self._read([*action.preconditions, *values])):
                new.add_precondition(condition)
            return new
        assert isinstance(action, DurativeAction)
        new.clear_conditions()
        new.clear_effects()
        duration = action.duration
        new.set_closed_duration_interval(self._over(duration.lower), self._over(duration.upper))
        read = [duration.lower, duration.upper]
        for interval, conditions in action.conditions.items():
            for condition in conditions:
                read.append(condition)
                self._condition(new, interval, self._over(condition))
        for timing, effects in action.effects.items():
            for effect in effects:
                read.append(effect.value)
                self._effect(new, timing, effect)
        for condition in self._sorted(self._read(read)):
            new.add_condition(StartTiming(), condition)
        return new

    @staticmethod
    def _sorted(nodes: set[FNode]) -> list[FNode]:
        return sorted(nodes, key=str)

    @staticmethod
    def _condition(
        action: DurativeAction, when: TimeInterval | TimePointInterval, condition: FNode
    ) -> None:
        action.add_condition(when, condition)

    def _effect(self, action: Action, timing: Timing | None, effect: Effect) -> None:
        add = (
            action.add_increase_effect
            if effect.is_increase()
            else action.add_decrease_effect
            if effect.is_decrease()
            else action.add_effect
        )
        parts = [self._over(one) for one in (effect.fluent, effect.value, effect.condition)]
        if timing is None:
            add(*parts, forall=effect.forall)
        else:
            add(timing, *parts, forall=effect.forall)

    def _timed(self, timing: Timing, effect: Effect) -> None:
        parts = [self._over(one) for one in (effect.fluent, effect.value, effect.condition)]
        self._new.add_timed_effect(timing, *parts)
