"""Problems of unified-planning as problems of ours, and plans in both directions.

unified-planning writes the PDDL; its bounded numbers and state invariants are compiled away by its
own compilers first. A fluent that an attachment computes is declared as a PDDL/M module.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import unified_planning as up
from unified_planning.engines import CompilationKind
from unified_planning.engines.compilers import BoundedTypesRemover, StateInvariantsRemover
from unified_planning.engines.results import CompilerResult
from unified_planning.io import PDDLWriter
from unified_planning.model import Object, Problem
from unified_planning.plans import ActionInstance, SequentialPlan, TimeTriggeredPlan

import planner
from planner.attachments import Attachment
from planner.s_expressions import Call, Expression, parse, write

SAME_TIME_S = 1e-9
"""Times closer than this are one time: what binary fractions lose of decimal ones."""


class Translation:
    """A problem of unified-planning, read by our reader."""

    def __init__(self, original: Problem, attachments: Mapping[str, Attachment]) -> None:
        """Translates; `attachments` maps names of numeric fluents to what computes them.

        Raises `planner.PddlError` or an exception of unified-planning where a problem cannot be
        written as PDDL.
        """
        self.original = original
        self._compiled = _compile(original)
        problem = self._compiled[-1].problem if self._compiled else original
        assert isinstance(problem, Problem)
        self.temporal = problem.kind.has_continuous_time()
        self.writer = PDDLWriter(problem)
        domain_text = _without_warnings(self.writer.get_domain)
        problem_text = _with_timed_values(_without_warnings(self.writer.get_problem))
        self.attachments: dict[str, Attachment] = {}
        modules = {}
        for name, attachment in attachments.items():
            pddl_name = self.writer.get_pddl_name(problem.fluent(name))
            modules[pddl_name.lower()] = pddl_name
            self.attachments[pddl_name] = _Renamed(self, attachment)
        if modules:
            domain_text = _with_modules(domain_text, modules)
            problem_text = _without_values(problem_text, modules)
        self.problem = planner.read_problem(planner.read_domain(domain_text), problem_text)

    def item(self, name: str) -> Any:
        """The action or object of the compiled problem that a PDDL name stands for."""
        return self.writer.get_item_named(name)

    def plan_back(self, plan: planner.Plan) -> up.plans.Plan:
        """A plan of ours as one for the original problem."""
        instances = []
        times: list[tuple[float, Fraction]] = [(0.0, Fraction(0))]
        for step in plan:
            action = self.item(step.action)
            arguments = tuple(map(self.item, step.arguments))
            start = _exact(step.start, times)
            duration = None if step.duration is None else Fraction(str(step.duration))
            times.append((step.end, start + (duration or 0)))
            instances.append((start, ActionInstance(action, arguments), duration))
        if self.temporal:
            result: up.plans.Plan = TimeTriggeredPlan(instances, self._environment)
        else:
            result = SequentialPlan([one for _, one, _ in instances], self._environment)
        for compiled in reversed(self._compiled):
            assert compiled.map_back_action_instance is not None
            result = result.replace_action_instances(compiled.map_back_action_instance)
        return result

    def plan_forth(self, plan: up.plans.Plan) -> planner.Plan:
        """A plan for the original problem as one of ours, by the names of actions and objects.

        Sequential plans get one second a step.
        """
        steps = []
        if isinstance(plan, TimeTriggeredPlan):
            timed: Sequence[tuple[Any, ActionInstance, Any]] = plan.timed_actions
        elif isinstance(plan, SequentialPlan):
            timed = [(index, action, None) for index, action in enumerate(plan.actions, 1)]
        else:
            raise up.exceptions.UPUsageError(f"plans of kind {plan.kind} cannot be translated")
        for start, instance, duration in timed:
            action = self.writer.get_pddl_name(self._compiled_action(instance.action.name))
            arguments = [
                self.writer.get_pddl_name(one.object()) for one in instance.actual_parameters
            ]
            steps.append(
                planner.Step(
                    float(start),
                    action.lower(),
                    tuple(name.lower() for name in arguments),
                    None if duration is None else float(duration),
                )
            )
        return planner.Plan(tuple(sorted(steps, key=lambda step: step.start)))

    @property
    def _environment(self) -> up.environment.Environment:
        return self.original.environment

    def _compiled_action(self, name: str) -> Any:
        """The action of the compiled problem that stands for one of the original."""
        problem = self._compiled[-1].problem if self._compiled else self.original
        assert isinstance(problem, Problem)
        return problem.action(name)


class _Renamed:
    """An attachment called with the names that unified-planning knows."""

    def __init__(self, translation: Translation, attachment: Attachment) -> None:
        self._translation = translation
        self._attachment = attachment
        self.purity = str(getattr(attachment, "purity", "arguments"))

    def __call__(self, *arguments: Any) -> Any:
        if self.purity == "arguments":
            return self.many([arguments])[0]
        return self.many([arguments[1:]], arguments[0])[0]

    def many(self, calls: Sequence[tuple[str, ...]], state: Any = None) -> Sequence[float]:
        renamed = [tuple(self._name(name) for name in call) for call in calls]
        extra = () if state is None else (state,)
        many = getattr(self._attachment, "many", None)
        if many is not None:
            values: Sequence[float] = many(renamed, *extra)
            return values
        return [self._attachment(*extra, *call) for call in renamed]  # type: ignore[operator]

    def _name(self, name: str) -> str:
        item = self._translation.item(name)
        return item.name if isinstance(item, Object) else name


def _compile(problem: Problem) -> list[CompilerResult]:
    """Compiles bounded numbers into state invariants, and those into conditions."""
    results: list[CompilerResult] = []
    for compiler, kind, needed in (
        (BoundedTypesRemover(), CompilationKind.BOUNDED_TYPES_REMOVING, "BOUNDED_TYPES"),
        (StateInvariantsRemover(), CompilationKind.STATE_INVARIANTS_REMOVING, "STATE_INVARIANTS"),
    ):
        if needed in problem.kind.features:
            compiler.skip_checks = True
            result = compiler.compile(problem, kind)
            assert isinstance(result.problem, Problem)
            results.append(result)
            problem = result.problem
    return results


def _without_warnings(call: Any) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return str(call())


def _with_timed_values(text: str) -> str:
    """Timed initial assignments as PDDL has them: their writer gives `(at 1 (assign (f) 2))`."""
    if "(assign " not in text:
        return text
    definition = parse(text)
    for section in definition:
        if isinstance(section, list) and _is_head(section, ":init"):
            for entry in section:
                if isinstance(entry, list) and _is_head(entry, "at") and len(entry) == 3:
                    change = entry[2]
                    if isinstance(change, list) and _is_head(change, "assign"):
                        change[0] = "="
    return write(definition)


def _exact(value: float, times: list[tuple[float, Fraction]]) -> Fraction:
    """The exact time that a float stands for: that of an earlier event, or its own digits."""
    for near, exact in times:
        if abs(near - value) <= SAME_TIME_S:
            return exact
    return Fraction(str(value))


def _with_modules(text: str, modules: Mapping[str, str]) -> str:
    """Turns the fluents that attachments compute into modules."""
    definition = parse(text)
    declarations: list[Expression] = []
    for section in definition:
        if isinstance(section, list) and section and section[0] == ":functions":
            kept = [one for one in section if not _is_one_of(one, modules)]
            declared = [one for one in section if _is_one_of(one, modules)]
            section[:] = kept
            for one in declared:
                assert isinstance(one, list)
                declarations.append([*one, "cost", f"{one[0]}@python"])
    rewritten = [
        section if _is_head(section, ":functions") else _called(section, modules)
        for section in definition
        if not (_is_head(section, ":functions") and len(section) == 1)
    ]
    place = next((i for i, section in enumerate(rewritten) if _is_head(section, ":predicates")), 2)
    rewritten.insert(place, [":modules", *declarations])
    return write(rewritten)


def _called(expression: Expression, modules: Mapping[str, str]) -> Expression:
    """A copy in which terms of these fluents are module calls."""
    if isinstance(expression, str):
        return expression
    parts = [_called(part, modules) for part in expression]
    return Call(parts) if _is_one_of(expression, modules) else parts


def _without_values(text: str, modules: Mapping[str, str]) -> str:
    """A problem without initial values of these fluents."""
    definition = parse(text)
    for section in definition:
        if isinstance(section, list) and _is_head(section, ":init"):
            section[:] = [
                entry
                for entry in section
                if not (_is_head(entry, "=") and _is_one_of(entry[1], modules))
            ]
    return write(definition)


def _is_head(expression: Expression, head: str) -> bool:
    return isinstance(expression, list) and bool(expression) and expression[0] == head


def _is_one_of(expression: Expression, names: Mapping[str, str]) -> bool:
    return (
        isinstance(expression, list)
        and bool(expression)
        and isinstance(expression[0], str)
        and expression[0].lower() in names
    )
