"""Solves problems: the whole answer at once, or improving plans as they are found."""

import time
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from types import MappingProxyType
from typing import Final

from planner import _core
from planner._core import Problem
from planner.attachments import Attachments, as_dict, attachment_error
from planner.diagnostics import InternalError, PlannerError
from planner.outcome import Outcome
from planner.plan import Plan, steps_of, tuples_of
from planner.proofs import proved, weakest_quality
from planner.reading import DomainLike, InputError, ProblemLike, read_problem

POLL_S = 0.1
"""How long to wait for the next plan before `on_progress` is called [s]."""
SOLVED_UNTIL: Final[Mapping[str | None, Outcome]] = MappingProxyType(
    {
        "time": Outcome.SOLVED_TIMED_OUT,
        "nodes": Outcome.SOLVED_OUT_OF_MEMORY,
        "memory": Outcome.SOLVED_OUT_OF_MEMORY,
        "cancelled": Outcome.SOLVED_CANCELLED,
    }
)
"""What a plan and the limit that ended the search make together."""


class UnsupportedError(PlannerError):
    """A problem that is understood but cannot be planned with."""

    outcome = Outcome.UNSUPPORTED


@dataclass(frozen=True, slots=True)
class Statistics:
    """What a search did."""

    expansions: int = 0
    """States whose successors were generated."""
    evaluations: int = 0
    """Heuristic evaluations."""
    schedules: int = 0
    """Plans built by the list-schedule search."""
    operators: int = 0
    """Ground operators."""
    facts: int = 0
    """Ground facts that states store."""
    grounding_s: float = 0.0
    """Time for grounding [s]."""
    wall_s: float = 0.0
    """Time since the call [s]."""
    cpu_s: float = 0.0
    """CPU time of this process, counted from its start [s]."""


@dataclass(frozen=True, slots=True)
class Progress:
    """What a search has done so far."""

    states: int
    """States expanded and plans built."""
    lower_bound: float
    """No plan is better than this; 0 if nothing is known."""


@dataclass(frozen=True, slots=True)
class Result:
    """How a search ended and what it found."""

    outcome: Outcome
    plans: tuple[Plan, ...] = ()
    """All improving plans, the best last."""
    lower_bound: float = 0.0
    """No plan is better than this (makespan [s], or metric value); 0 if nothing is known."""
    statistics: Statistics = Statistics()

    @property
    def plan(self) -> Plan | None:
        """The best plan, or None."""
        return self.plans[-1] if self.plans else None

    @property
    def gap(self) -> float | None:
        """How much better than the best plan an optimal one could be, as a part of it."""
        if self.plan is None or self.plan.makespan <= 0:
            return None
        return max(0.0, 1.0 - self.lower_bound / self.plan.makespan)


class Heuristic(StrEnum):
    """What may guide the decision-epoch search."""

    TEMPORAL_FF = "temporal-ff"
    """Length of a relaxed plan whose supporters are chosen by additive costs."""
    CONTEXT_ENHANCED_ADDITIVE = "context-enhanced-additive"
    """Additive costs along domain transition graphs, each from where the steps before lead."""
    CRITICAL_PATH = "critical-path"
    """Least time to the goals when every action waits only for its latest condition; admissible."""
    BLIND = "blind"
    """Whether the goal holds."""
    ALTERNATION = "alternation"
    """Temporal FF and context-enhanced additive, their open lists in turns."""


class Space(StrEnum):
    """Which spaces are searched."""

    PORTFOLIO = "portfolio"
    """List schedules and decision epochs in turns."""
    DECISION_EPOCHS = "decision-epochs"
    """Decision epochs alone: for measuring and comparing heuristics."""


def _named(kind: type[StrEnum], value: str) -> StrEnum:
    """The member of a name."""
    try:
        return kind(value)
    except ValueError:
        known = ", ".join(kind)
        raise InputError(f"no {kind.__name__.lower()} is called {value}; known: {known}") from None


@dataclass(frozen=True, slots=True)
class Limits:
    """What bounds and steers a search."""

    timeout_s: float | None = 10.0
    """Wall-clock time [s], reading and grounding included; None is until done."""
    seed: int = 0
    """Of all random choices."""
    threads: int = 1
    """With one thread, a seed and a node limit the same input gives the same plans."""
    node_limit: int | None = None
    """Expansions and plan evaluations after which to stop."""
    memory_limit_mb: int | None = None
    """Memory that searching may hold [MiB]; None is 2048."""
    first_plan_only: bool = False
    """Whether to stop at the first plan."""
    cpu_timeout_s: float | None = None
    """CPU time of this process, counted from its start [s]."""
    heuristic: Heuristic | str | None = None
    """What guides the decision-epoch search; None leaves it to the portfolio."""
    space: Space | str = Space.PORTFOLIO
    """Which spaces are searched."""
    promptness: float = 0.0
    """Weight of the mean time at which goals are reached, beside the makespan."""

    def __post_init__(self) -> None:
        for name, value, least in (
            ("timeout_s", self.timeout_s, 0),
            ("seed", self.seed, 0),
            ("threads", self.threads, 1),
            ("node_limit", self.node_limit, 1),
            ("memory_limit_mb", self.memory_limit_mb, 1),
            ("cpu_timeout_s", self.cpu_timeout_s, 0),
            ("promptness", self.promptness, 0),
        ):
            if value is not None and not value >= least:
                raise InputError(f"{name} is {value}, but must be at least {least}")
        if self.heuristic is not None:
            object.__setattr__(self, "heuristic", _named(Heuristic, self.heuristic))
        object.__setattr__(self, "space", _named(Space, self.space))

    def since(self, begun_s: float) -> "Limits":
        """The same with what is left of the wall-clock time since `time.monotonic()` was so."""
        if self.timeout_s is None:
            return self
        spent_s = time.monotonic() - begun_s
        return replace(self, timeout_s=max(0.0, self.timeout_s - spent_s))


def solve(
    domain: DomainLike,
    problem: ProblemLike,
    *,
    attachments: Attachments | None = None,
    timeout_s: float | None = 10.0,
    seed: int = 0,
    threads: int = 1,
    node_limit: int | None = None,
    memory_limit_mb: int | None = None,
    first_plan_only: bool = False,
    warm_start: Plan | None = None,
    promptness: float = 0.0,
    on_plan: Callable[[Plan], None] | None = None,
    heuristic: Heuristic | str | None = None,
    space: Space | str = Space.PORTFOLIO,
) -> Result:
    """Searches until the limits or until the best plan is proved optimal.

    `domain` and `problem` are paths, texts or what `read_domain` / `read_problem` returned;
    `attachments` maps names of modules to callables (see `planner.attachments`). `warm_start` is
    the plan in execution, its times counted from now: what is left of it may be the first plan.
    With a `promptness` above 0 plans also count the mean time at which their goals are reached,
    that many times as much as the makespan: right where the goals are only those known so far.
    `on_plan` is called with every improving plan. Every plan has passed the validator.
    `heuristic` guides the decision-epoch search, `space` may be that search alone.

    Raises `PddlError` for texts that cannot be read, `AttachmentError` for an attachment that is
    missing or fails, `UnsupportedError` for a problem that is understood but cannot be planned
    with, `InternalError` if the planner contradicts itself. Ctrl-C raises KeyboardInterrupt.
    """
    begun_s = time.monotonic()
    limits = Limits(
        timeout_s,
        seed,
        threads,
        node_limit,
        memory_limit_mb,
        first_plan_only,
        heuristic=heuristic,
        space=space,
        promptness=promptness,
    )
    parsed = read_problem(domain, problem)
    plans = improving_plans(parsed, attachments, limits.since(begun_s), warm_start)
    while True:
        try:
            plan = next(plans)
        except StopIteration as end:
            result: Result = end.value
            return result
        if on_plan is not None:
            on_plan(plan)


def solve_anytime(
    domain: DomainLike,
    problem: ProblemLike,
    *,
    attachments: Attachments | None = None,
    timeout_s: float | None = 10.0,
    seed: int = 0,
    threads: int = 1,
    node_limit: int | None = None,
    memory_limit_mb: int | None = None,
    warm_start: Plan | None = None,
    heuristic: Heuristic | str | None = None,
    space: Space | str = Space.PORTFOLIO,
) -> Generator[Plan, None, Result]:
    """Improving plans as they are found; the value of StopIteration is the `Result`.

    Takes and raises what `solve` does. The search goes on while the caller works with a plan and
    stops when the iterator is closed or dropped.
    """
    limits = Limits(
        timeout_s,
        seed,
        threads,
        node_limit,
        memory_limit_mb,
        heuristic=heuristic,
        space=space,
    )
    return improving_plans(read_problem(domain, problem), attachments, limits, warm_start)


def improving_plans(
    problem: Problem,
    attachments: Attachments | None,
    limits: Limits,
    warm_start: Plan | None = None,
    on_wait: Callable[[Progress], object] | None = None,
) -> Generator[Plan, None, Result]:
    """What `solve` and `solve_anytime` do; `on_wait` is called while there is no new plan."""
    begun = time.monotonic()
    quality = weakest_quality(attachments, [module.name for module in problem.domain.modules])
    search = started(problem, attachments, limits, warm_start)
    plans: list[Plan] = []
    cpu_timed_out = False
    try:
        while True:
            event = search.next(_wait_s(limits))
            if event is None:
                if on_wait is not None:
                    on_wait(Progress(*search.progress()))
            elif event.plan is not None:
                steps, metric, wall_s = event.plan
                plan = Plan(steps_of(steps), problem.domain.name, problem.name, metric)
                plan = replace(plan, cpu_s=time.process_time(), wall_s=wall_s)
                plans.append(plan)
                yield plan
            elif event.report is not None:
                wall_s = time.monotonic() - begun
                result = _result(event.report, tuple(plans), wall_s, cpu_timed_out)
                outcome, lower_bound = proved(result.outcome, result.lower_bound, quality)
                return replace(result, outcome=outcome, lower_bound=lower_bound)
            else:
                raise _fault(event)
            if limits.cpu_timeout_s is not None and time.process_time() >= limits.cpu_timeout_s:
                cpu_timed_out = True
                search.cancel()
    finally:
        search.cancel()


def started(
    problem: Problem,
    attachments: Attachments | None,
    limits: Limits,
    warm_start: Plan | None = None,
) -> _core.Search:
    """A search that runs from now on, in a thread of its own."""
    return _core.Search(
        problem,
        as_dict(attachments),
        timeout_s=limits.timeout_s,
        cpu_timeout_s=limits.cpu_timeout_s,
        seed=limits.seed,
        threads=limits.threads,
        node_limit=limits.node_limit,
        memory_limit=None if limits.memory_limit_mb is None else limits.memory_limit_mb << 20,
        first_plan_only=limits.first_plan_only,
        warm_start=None if warm_start is None else tuples_of(warm_start),
        heuristic=limits.heuristic,
        space=limits.space,
        promptness=limits.promptness,
    )


def _wait_s(limits: Limits) -> float:
    """How long to wait for the next event: until all threads can have used up the CPU time."""
    if limits.cpu_timeout_s is None:
        return POLL_S
    left_s = limits.cpu_timeout_s - time.process_time()
    return min(POLL_S, max(0.001, left_s / (limits.threads + 1)))


def _fault(event: _core.Event) -> PlannerError:
    """The exception for a search that failed."""
    if event.attachment is not None:
        return attachment_error(event.attachment, event.exception)
    if event.refused is not None:
        return UnsupportedError(event.refused)
    return InternalError(f"{event.internal}; please report it with the domain and problem")


def _result(
    report: _core.Report,
    plans: tuple[Plan, ...],
    wall_s: float,
    cpu_timed_out: bool,
) -> Result:
    """The result, with the limit that ended the search in its outcome."""
    outcome = Outcome(report.outcome)
    if cpu_timed_out and outcome is Outcome.CANCELLED:
        outcome = Outcome.TIMED_OUT
    elif outcome is Outcome.SOLVED:
        # The CPU time is watched here and ends the search by cancelling it.
        limit = "time" if cpu_timed_out and report.limit == "cancelled" else report.limit
        outcome = SOLVED_UNTIL.get(limit, outcome)
    statistics = Statistics(
        report.expansions,
        report.evaluations,
        report.schedules,
        report.operators,
        report.facts,
        report.grounding_s,
        wall_s,
        time.process_time(),
    )
    return Result(outcome, plans, report.lower_bound, statistics)
