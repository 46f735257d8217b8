"""Attachments' share of planning time, and what a pure Python attachment costs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from time import process_time
from typing import Any

import planner
from planner.solving import Limits, improving_plans
from scenarios.benchmarks.attachments.hospital import hospital_problem, hospital_world
from scenarios.benchmarks.attachments.measuring import cpu_s, table
from scenarios.benchmarks.attachments.python_map import python_path_costs
from semantic_attachments import Attachment, Memory, World, bind
from semantic_attachments.grid import ATTACHMENTS, path_costs

Call = tuple[str, ...]


@dataclass
class Timed:
    """An attachment and the CPU time spent in it."""

    inner: Any
    spent_s: float = 0.0
    calls: int = 0

    def __call__(self, *arguments: str) -> float:
        return self.many([arguments])[0]

    def many(self, calls: Sequence[Call]) -> Sequence[float]:
        """Asks it in a batch."""
        begun_s = process_time()
        try:
            values: Sequence[float] = self.inner.many(calls)
            return values
        finally:
            self.spent_s += process_time() - begun_s
            self.calls += len(calls)


def run(*, quick: bool) -> str:
    """The disaster instance until the first plan, for a second, and for a while."""
    world = hospital_world()
    search_s = 2.0 if quick else 30.0
    rows, totals = [], []
    for name in ("native",) if quick else ("native", "pure Python"):
        first, spent_s = measure(name, world, search_cpu_s=120.0, first_plan_only=True)
        rows.append([name, "first plan", *first])
        # As long a search for both: what the attachment takes comes on top.
        for seconds in (1.0, search_s):
            whole, _ = measure(name, world, search_cpu_s=seconds + spent_s, first_plan_only=False)
            rows.append([name, f"{seconds:g} s of search", *whole])
        totals.append((first[0], whole[0]))
    columns = [
        "attachment",
        "until",
        "total [s]",
        "attachments [s]",
        "share",
        "calls",
        "makespan [s]",
    ]
    report = table("Disaster instance, 15 targets and 18 blockades", columns, rows)
    report = f"{report}\n\n{border(world)}"
    if len(totals) < 2:
        return report
    first_ratio, whole_ratio = (python / native for native, python in zip(*totals, strict=True))
    ratios = f"{first_ratio:.2f} to the first plan, {whole_ratio:.2f} for the whole search"
    return f"{report}\n\nPure Python / native, all of planning: {ratios}."


@dataclass(frozen=True)
class OneByOne:
    """Path costs from a table, in Python; each is asked alone."""

    known_s: dict[Call, float]

    def __call__(self, *call: str) -> float:
        return self.known_s[call]


class InBatches(OneByOne):
    """The same with a batch form."""

    def many(self, calls: Sequence[Call]) -> list[float]:
        """All of them at once."""
        return [self.known_s[call] for call in calls]


def border(world: World) -> str:
    """What the way through Python costs alone: all path costs are known before."""
    memory, problem = Memory(), hospital_problem()
    costs = path_costs(world, memory)
    calls: list[Call] = [
        (r, a, b) for r in world.robots for a in world.locations for b in world.locations
    ]
    known_s = dict(zip(calls, costs.many(calls), strict=True))
    (declared,) = (one for one in ATTACHMENTS if one.name == "pathCost")
    rows, native_s = [], 0.0
    for name, bound in (
        ("native", lambda *_: costs),
        ("Python, in batches", lambda *_: InBatches(known_s)),
        ("Python, one by one", lambda *_: OneByOne(known_s)),
    ):
        given = [replace(declared, bind=bound)]

        def first_plan(given: Sequence[Attachment] = given) -> planner.Result:
            attachments = bind(["pathCost", "clearCost"], world, attachments=given)
            return planner.solve(
                problem.domain, problem, attachments=attachments, timeout_s=60, first_plan_only=True
            )

        total_s, _ = cpu_s(first_plan, repeats=5)
        native_s = native_s or total_s
        rows.append([name, total_s, total_s / native_s])
    columns = ["path costs", "until the first plan [s]", "ratio"]
    return table("Known path costs: what asking takes", columns, rows)


def measure(
    name: str, world: World, *, search_cpu_s: float, first_plan_only: bool
) -> tuple[list[float], float]:
    """Total and attachment CPU time [s], share, calls, makespan [s]; attachment time again."""
    native = bind(["pathCost", "clearCost"], world)
    timed = {
        "pathCost": Timed(native["pathCost"] if name == "native" else python_path_costs(world)),
        "clearCost": Timed(native["clearCost"]),
    }
    problem = hospital_problem()
    begun_s = process_time()
    limits = Limits(
        timeout_s=None, cpu_timeout_s=begun_s + search_cpu_s, first_plan_only=first_plan_only
    )
    makespan = inf
    for plan in improving_plans(problem, timed, limits):
        makespan = plan.makespan
    total_s = process_time() - begun_s
    spent_s = sum(one.spent_s for one in timed.values())
    calls = sum(one.calls for one in timed.values())
    return [total_s, spent_s, spent_s / total_s, calls, makespan], spent_s
