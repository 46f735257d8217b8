"""The engine `marsupial` of unified-planning: oneshot, anytime, replanner and plan validation.

Importing this module registers it:

    import planner.unified_planning_engine
    with OneshotPlanner(name="marsupial", params={"attachments": {"travel_time": f}}) as engine:
        result = engine.solve(problem, timeout=10)

Parameters: `attachments` (numeric fluents computed by a callable of the objects' names instead of
initial values), `seed`, `threads`, `node_limit`, `memory_limit_mb`, `timeout_s` (the default limit,
10 s), `heuristic` and `space` (names of `planner.Heuristic` and `planner.Space`).
"""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import IO, Any

import unified_planning as up
from unified_planning.engines import (
    Credits,
    Engine,
    PlanGenerationResult,
    PlanGenerationResultStatus,
    ValidationResult,
    ValidationResultStatus,
)
from unified_planning.engines.mixins import (
    AnytimePlannerMixin,
    OneshotPlannerMixin,
    PlanValidatorMixin,
    ReplannerMixin,
)
from unified_planning.engines.mixins.anytime_planner import AnytimeGuarantee
from unified_planning.engines.results import FailedValidationReason, LogLevel, LogMessage
from unified_planning.exceptions import UPException
from unified_planning.model import Problem, ProblemKind
from unified_planning.plans import PlanKind
from unified_planning.shortcuts import get_environment

import planner
from planner.attachments import Attachment
from planner.outcome import Outcome
from planner.solving import Limits, Result, Space, improving_plans
from planner.unified_planning_translation import Translation

NAME = "marsupial"

CREDITS = Credits(
    "marsupial",
    "the marsupial developers",
    "",
    "",
    "MIT",
    "Temporal planner with semantic attachments",
    "Anytime temporal planning for PDDL 2.1 levels 1-3 with PDDL/M modules: decision-epoch search "
    "and plan improvement over list schedules; every plan is validated.",
)

_STATUS = {
    Outcome.SOLVED_OPTIMALLY: PlanGenerationResultStatus.SOLVED_OPTIMALLY,
    Outcome.SOLVED: PlanGenerationResultStatus.SOLVED_SATISFICING,
    Outcome.SOLVED_OUT_OF_MEMORY: PlanGenerationResultStatus.SOLVED_SATISFICING,
    Outcome.SOLVED_TIMED_OUT: PlanGenerationResultStatus.SOLVED_SATISFICING,
    Outcome.SOLVED_CANCELLED: PlanGenerationResultStatus.SOLVED_SATISFICING,
    Outcome.PROVEN_UNSOLVABLE: PlanGenerationResultStatus.UNSOLVABLE_PROVEN,
    Outcome.EXHAUSTED: PlanGenerationResultStatus.UNSOLVABLE_INCOMPLETELY,
    Outcome.OUT_OF_MEMORY: PlanGenerationResultStatus.MEMOUT,
    Outcome.OUT_OF_NODES: PlanGenerationResultStatus.MEMOUT,
    Outcome.TIMED_OUT: PlanGenerationResultStatus.TIMEOUT,
    Outcome.CANCELLED: PlanGenerationResultStatus.TIMEOUT,
}

_KIND = {
    "problem_class": ("ACTION_BASED",),
    "problem_type": ("SIMPLE_NUMERIC_PLANNING", "GENERAL_NUMERIC_PLANNING"),
    "time": ("CONTINUOUS_TIME", "TIMED_EFFECTS", "DURATION_INEQUALITIES"),
    "expression_duration": (
        "STATIC_FLUENTS_IN_DURATIONS",
        "FLUENTS_IN_DURATIONS",
        "INT_TYPE_DURATIONS",
        "REAL_TYPE_DURATIONS",
    ),
    "numbers": ("BOUNDED_TYPES",),
    "conditions_kind": (
        "NEGATIVE_CONDITIONS",
        "DISJUNCTIVE_CONDITIONS",
        "EQUALITIES",
        "EXISTENTIAL_CONDITIONS",
        "UNIVERSAL_CONDITIONS",
    ),
    "effects_kind": (
        "CONDITIONAL_EFFECTS",
        "INCREASE_EFFECTS",
        "DECREASE_EFFECTS",
        "STATIC_FLUENTS_IN_NUMERIC_ASSIGNMENTS",
        "FLUENTS_IN_NUMERIC_ASSIGNMENTS",
        "FORALL_EFFECTS",
    ),
    "typing": ("FLAT_TYPING", "HIERARCHICAL_TYPING"),
    "fluents_type": ("INT_FLUENTS", "REAL_FLUENTS"),
    "quality_metrics": ("ACTIONS_COST", "FINAL_VALUE", "MAKESPAN", "PLAN_LENGTH"),
    "actions_cost_kind": (
        "STATIC_FLUENTS_IN_ACTIONS_COST",
        "FLUENTS_IN_ACTIONS_COST",
        "INT_NUMBERS_IN_ACTIONS_COST",
        "REAL_NUMBERS_IN_ACTIONS_COST",
    ),
    "constraints_kind": ("STATE_INVARIANTS",),
    "initial_state": ("UNDEFINED_INITIAL_NUMERIC",),
}


class MarsupialEngine(
    Engine,  # type: ignore[misc]  # unified-planning has no types
    OneshotPlannerMixin,  # type: ignore[misc]
    AnytimePlannerMixin,  # type: ignore[misc]
    ReplannerMixin,  # type: ignore[misc]
    PlanValidatorMixin,  # type: ignore[misc]
):
    """Adapter: translates problems to PDDL and plans back."""

    def __init__(
        self,
        problem: Problem | None = None,
        error_on_failed_checks: bool = True,
        *,
        attachments: Mapping[str, Attachment] | None = None,
        timeout_s: float | None = 10.0,
        seed: int = 0,
        threads: int = 1,
        node_limit: int | None = None,
        memory_limit_mb: int | None = None,
        heuristic: str | None = None,
        space: str = Space.PORTFOLIO,
        **options: Any,
    ) -> None:
        if options:
            raise up.exceptions.UPUsageError(
                f"{NAME} has no parameters {sorted(options)}; it takes attachments, timeout_s, "
                "seed, threads, node_limit, memory_limit_mb, heuristic and space"
            )
        Engine.__init__(self)
        OneshotPlannerMixin.__init__(self)
        AnytimePlannerMixin.__init__(self)
        PlanValidatorMixin.__init__(self)
        self._attachments = dict(attachments or {})
        self._limits = Limits(
            timeout_s,
            seed,
            threads,
            node_limit,
            memory_limit_mb,
            heuristic=heuristic,
            space=space,
        )
        self._last_plan: up.plans.Plan | None = None
        if problem is not None:
            ReplannerMixin.__init__(self, problem, error_on_failed_checks)

    @property
    def name(self) -> str:
        """The name it is asked for by."""
        return NAME

    @staticmethod
    def supported_kind() -> ProblemKind:
        """What it plans with; everything else is declined by name."""
        kind = ProblemKind(version=up.model.problem_kind_versioning.LATEST_PROBLEM_KIND_VERSION)
        for group, features in _KIND.items():
            for feature in features:
                getattr(kind, f"set_{group}")(feature)
        return kind

    @staticmethod
    def supports(problem_kind: ProblemKind) -> bool:
        """Whether it plans with all features of a problem."""
        return bool(problem_kind <= MarsupialEngine.supported_kind())

    @staticmethod
    def supports_plan(plan_kind: PlanKind) -> bool:
        """Plans that it validates."""
        return plan_kind in {PlanKind.TIME_TRIGGERED_PLAN, PlanKind.SEQUENTIAL_PLAN}

    @staticmethod
    def ensures(anytime_guarantee: AnytimeGuarantee) -> bool:
        """Every plan is better than the one before."""
        return bool(anytime_guarantee == AnytimeGuarantee.INCREASING_QUALITY)

    @staticmethod
    def get_credits(**_: Any) -> Credits:
        """Who made it."""
        return CREDITS

    # Oneshot and anytime planning.

    def _solve_with_params(
        self,
        problem: up.model.AbstractProblem,
        heuristic: Callable[[up.model.State], float | None] | None = None,
        timeout: float | None = None,
        output_stream: IO[str] | None = None,
        warm_start_plan: up.plans.Plan | None = None,
        **_: Any,
    ) -> PlanGenerationResult:
        if heuristic is not None:
            raise up.exceptions.UPUsageError(f"{NAME} takes no heuristic")
        results = self._get_solutions_with_params(problem, timeout, output_stream, warm_start_plan)
        return deque(results, maxlen=1).pop()

    def _solve(
        self,
        problem: up.model.AbstractProblem,
        heuristic: Callable[[up.model.State], float | None] | None = None,
        timeout: float | None = None,
        output_stream: IO[str] | None = None,
    ) -> PlanGenerationResult:
        return self._solve_with_params(problem, heuristic, timeout, output_stream)

    def _get_solutions(
        self,
        problem: up.model.AbstractProblem,
        timeout: float | None = None,
        output_stream: IO[str] | None = None,
    ) -> Iterator[PlanGenerationResult]:
        return self._get_solutions_with_params(problem, timeout, output_stream)

    def _get_solutions_with_params(
        self,
        problem: up.model.AbstractProblem,
        timeout: float | None = None,
        output_stream: IO[str] | None = None,
        warm_start_plan: up.plans.Plan | None = None,
        **_: Any,
    ) -> Iterator[PlanGenerationResult]:
        try:
            translation = self._translate(problem)
        except (UPException, planner.PlannerError, NotImplementedError) as error:
            yield self._failed(PlanGenerationResultStatus.UNSUPPORTED_PROBLEM, error)
            return
        limits = self._limits if timeout is None else replace(self._limits, timeout_s=timeout)
        warm_start = None if warm_start_plan is None else translation.plan_forth(warm_start_plan)
        search = improving_plans(translation.problem, translation.attachments, limits, warm_start)
        best = None
        try:
            while True:
                plan = next(search)
                best = translation.plan_back(plan)
                if output_stream is not None:
                    output_stream.write(plan.to_text())
                yield PlanGenerationResult(
                    PlanGenerationResultStatus.INTERMEDIATE, best, NAME, _figures(plan)
                )
        except StopIteration as end:
            yield self._final(end.value, best)
        except planner.UnsupportedError as error:
            yield self._failed(PlanGenerationResultStatus.UNSUPPORTED_PROBLEM, error)
        except planner.InternalError as error:
            yield self._failed(PlanGenerationResultStatus.INTERNAL_ERROR, error)

    def _translate(self, problem: up.model.AbstractProblem) -> Translation:
        if not isinstance(problem, Problem):
            raise up.exceptions.UPUsageError(f"{NAME} plans for action-based problems only")
        return Translation(problem, self._attachments)

    def _final(self, result: Result, plan: up.plans.Plan | None) -> PlanGenerationResult:
        metrics = {
            "lower_bound": str(result.lower_bound),
            "expansions": str(result.statistics.expansions),
            "engine_internal_time": str(result.statistics.wall_s),
        }
        if result.plan is not None:
            metrics |= _figures(result.plan)
        message = LogMessage(LogLevel.INFO, result.outcome.row.meaning)
        return PlanGenerationResult(_STATUS[result.outcome], plan, NAME, metrics, [message])

    def _failed(self, status: PlanGenerationResultStatus, error: Exception) -> PlanGenerationResult:
        return PlanGenerationResult(
            status, None, NAME, None, [LogMessage(LogLevel.ERROR, str(error))]
        )

    # Replanning: the problem given at the start is changed, the last plan is the first to try.

    def _resolve(
        self, timeout: float | None = None, output_stream: IO[str] | None = None
    ) -> PlanGenerationResult:
        result = self._solve_with_params(
            self._problem, None, timeout, output_stream, self._usable_last_plan()
        )
        self._last_plan = result.plan
        return result

    def _usable_last_plan(self) -> up.plans.Plan | None:
        """The last plan, unless an action of it is gone."""
        if self._last_plan is None:
            return None
        known = {action.name for action in self._problem.actions}
        timed = getattr(self._last_plan, "timed_actions", None)
        actions = [a for _, a, _ in timed] if timed is not None else self._last_plan.actions
        return self._last_plan if all(a.action.name in known for a in actions) else None

    def _update_initial_value(self, fluent: Any, value: Any) -> None:
        self._problem.set_initial_value(fluent, value)

    def _add_goal(self, goal: Any) -> None:
        self._problem.add_goal(goal)

    def _remove_goal(self, goal: Any) -> None:
        (wanted,) = self._problem.environment.expression_manager.auto_promote(goal)
        goals = list(self._problem.goals)
        if wanted not in goals:
            self._complain(f"the goal {wanted} is not in the problem")
            return
        goals.remove(wanted)
        self._problem.clear_goals()
        for one in goals:
            self._problem.add_goal(one)

    def _add_action(self, action: up.model.Action) -> None:
        self._problem.add_action(action)

    def _remove_action(self, name: str) -> None:
        kept = [action for action in self._problem.actions if action.name != name]
        if len(kept) == len(self._problem.actions):
            self._complain(f"the action {name} is not in the problem")
            return
        self._problem.clear_actions()
        self._problem.add_actions(kept)

    def _complain(self, message: str) -> None:
        if self._error_on_failed_checks:
            raise up.exceptions.UPUsageError(message)
        warnings.warn(message, stacklevel=4)

    # Validation.

    def _validate(self, problem: up.model.AbstractProblem, plan: up.plans.Plan) -> ValidationResult:
        translation = self._translate(problem)
        verdict = planner.validate(
            translation.problem.domain,
            translation.problem,
            translation.plan_forth(plan),
            attachments=translation.attachments,
        )
        if verdict.valid:
            return ValidationResult(ValidationResultStatus.VALID, NAME)
        goal = verdict.reason == "goal"
        return ValidationResult(
            ValidationResultStatus.INVALID,
            NAME,
            [LogMessage(LogLevel.INFO, verdict.message or "")],
            None,
            FailedValidationReason.UNSATISFIED_GOALS
            if goal
            else FailedValidationReason.INAPPLICABLE_ACTION,
        )


def _figures(plan: planner.Plan) -> dict[str, str]:
    figures = {"makespan": str(plan.makespan)}
    if plan.metric is not None:
        figures["metric"] = str(plan.metric)
    return figures


get_environment().factory.add_engine(NAME, __name__, "MarsupialEngine")
