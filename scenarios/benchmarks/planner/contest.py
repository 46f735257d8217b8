"""One engine on one problem, in a process of its own with limits of CPU time and memory."""

from __future__ import annotations

import multiprocessing
import resource
from dataclasses import asdict, dataclass
from typing import Any

from scenarios.benchmarks.planner.engines import OWN
from scenarios.benchmarks.planner.instances import Instance

WALL_FACTOR = 6.0
"""Wall seconds allowed for a CPU second: the machine may be busy."""

MEMORY_BYTES = 4 << 30
"""Address space that each process of an engine may take, as in the planning competitions."""


@dataclass(frozen=True, slots=True)
class Run:
    """What an engine reached."""

    instance: str
    family: str
    engine: str
    outcome: str
    plans: tuple[tuple[float | None, float], ...] = ()
    """Valid improving plans: when (CPU time [s]; None for peers, which do not say), value."""
    lower_bound: float = 0.0
    cpu_s: float = 0.0
    peak_mb: float = 0.0
    expansions: int = 0
    schedules: int = 0

    @property
    def best(self) -> float | None:
        """The value of the best plan."""
        return self.plans[-1][1] if self.plans else None

    def as_json(self) -> dict[str, Any]:
        """Plain types."""
        return asdict(self)

    @classmethod
    def from_json(cls, fields: dict[str, Any]) -> Run:
        """The inverse of `as_json`."""
        plans = tuple((when_s, value) for when_s, value in fields["plans"])
        return cls(**{**fields, "plans": plans})


def run_own(instance: Instance, limit_s: float, seed: int = 0) -> Run:
    """Our planner with a seed of its own."""
    return run_engine(OWN, instance, limit_s, seed)


def run_engine(engine: str, instance: Instance, limit_s: float, seed: int = 0) -> Run:
    """Runs in a new process, so that limits and peak memory are its own.

    The seed is ours; peers have their own fixed one.
    """
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(sender, engine, instance, limit_s, seed))
    process.start()
    sender.close()
    try:
        if receiver.poll(WALL_FACTOR * limit_s + 60):
            run: Run = receiver.recv()
            return run
        outcome = "no answer"
    except EOFError:
        outcome = "crashed"
    finally:
        process.kill()
        process.join()
    return Run(instance.name, instance.family, engine, outcome)


def _work(sender: Any, engine: str, instance: Instance, limit_s: float, seed: int) -> None:
    from planner.diagnostics import PlannerError

    try:
        own = engine == OWN
        run = _own(instance, limit_s, seed) if own else _peer(engine, instance, limit_s)
    except PlannerError as error:
        run = Run(instance.name, instance.family, engine, f"refused: {str(error).splitlines()[0]}")
    sender.send(run)


def _own(instance: Instance, limit_s: float, seed: int) -> Run:
    from planner.memory import peak_mb
    from planner.reading import read_problem
    from planner.solving import Limits, improving_plans

    begun_s = _cpu_s(resource.RUSAGE_SELF)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    limits = Limits(timeout_s=WALL_FACTOR * limit_s, cpu_timeout_s=begun_s + limit_s, seed=seed)
    problem = read_problem(instance.domain, instance.problem)
    found = improving_plans(problem, None, limits)
    plans = []
    while True:
        try:
            plan = next(found)
        except StopIteration as end:
            result = end.value
            break
        value = plan.makespan if plan.metric is None else plan.metric
        plans.append(((plan.cpu_s or 0.0) - begun_s, value))
    return Run(
        instance.name,
        instance.family,
        OWN,
        result.outcome.value,
        tuple(plans),
        result.lower_bound,
        _cpu_s(resource.RUSAGE_SELF) - begun_s,
        peak_mb(),
        result.statistics.expansions,
        result.statistics.schedules,
    )


def _peer(engine: str, instance: Instance, limit_s: float) -> Run:
    from planner.peers import solve_with_peer
    from planner.reading import read_problem

    problem = read_problem(instance.domain, instance.problem)
    # Its processes inherit the limits; a peer that counts wall time gets more of that.
    whole_s = max(1, round(limit_s + _cpu_s(resource.RUSAGE_SELF)))
    resource.setrlimit(resource.RLIMIT_CPU, (whole_s, whole_s + 5))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    result = solve_with_peer(engine, problem, {}, WALL_FACTOR * limit_s)
    values = (plan.makespan if plan.metric is None else plan.metric for plan in result.plans)
    return Run(
        instance.name,
        instance.family,
        engine,
        result.outcome.value,
        tuple((None, value) for value in sorted(values, reverse=True)),
        cpu_s=_cpu_s(resource.RUSAGE_CHILDREN),
        peak_mb=resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024,
    )


def _cpu_s(who: int) -> float:
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime
