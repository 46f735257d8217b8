"""How soon a plan is in force again after a target was reached or a blockade appeared."""

from __future__ import annotations

import re
import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from planner import Plan, Step, read_domain, read_problem, solve
from planner.solving import Limits, improving_plans
from scenarios.benchmarks._markdown import table

HOSPITAL = Path("../shared/data/instances/disaster/d07-3x2-t15-b18.pddl")
SIZE_S = 200
"""Time to clear the blockade that appears [s]."""
LATER_S = 0.1
"""CPU time after which plans are looked at again [s]."""
BEFORE_TARGET = 0.9
"""Where it lies on each way to its target, as a part of the way."""


@dataclass(frozen=True, slots=True)
class News:
    """What has happened: the problem now, and what is left of the plan in execution."""

    title: str
    problem: str
    rest: Plan


def run(*, quick: bool) -> str:
    """First plans with and without a warm start at hospital size; empty where the file is absent.

    CPU time, least of several runs, with reading the new problem; over all targets that may be the
    one, the median and the worst.
    """
    if not HOSPITAL.is_file():
        return ""
    domain = read_domain(HOSPITAL.with_name("domain.pddl"))
    text = HOSPITAL.read_text(encoding="utf-8")
    plan = solve(domain, read_problem(domain, text), timeout_s=1.0 if quick else 5.0).plan
    if plan is None:
        return "No plan at hospital size."
    explorations = [step for step in plan.steps if step.action.startswith("explore")]
    news = [reached(text, plan, step) for step in first_of_each(explorations)]
    news += [blocked(text, plan, step) for step in explorations]
    rows = []
    for title in dict.fromkeys(one.title for one in news):
        for start in ("cold", "warm"):
            measured = [
                min(
                    _first_plan(domain, one.problem, one.rest if start == "warm" else None)
                    for _ in range(3 if quick else 7)
                )
                for one in news
                if one.title == title
            ]
            total_ms, read_ms = ([1000 * times[k] for times in measured] for k in (0, 1))
            makespans_s = [f"{statistics.mean(times[k] for times in measured):.0f}" for k in (2, 3)]
            times_ms = [f"{statistics.median(total_ms):.1f}", f"{max(total_ms):.1f}"]
            reading_ms = f"{statistics.median(read_ms):.1f}"
            rows.append([title, str(len(measured)), start, *times_ms, reading_ms, *makespans_s])
    columns = ["what happens", "cases", "start", "valid plan after [ms]", "worst", "of it reading"]
    columns += ["mean makespan", f"{LATER_S:g} s later"]
    return table("Replan at hospital size", columns, rows)


def _first_plan(
    domain: object, problem: str, warm: Plan | None
) -> tuple[float, float, float, float]:
    """CPU time to a valid plan, its part for reading; that plan's makespan, a later one [s]."""
    begun_s = time.process_time()
    task = read_problem(domain, problem)  # type: ignore[arg-type]
    read_s = time.process_time() - begun_s
    limits = Limits(cpu_timeout_s=begun_s + LATER_S)
    plans = improving_plans(task, None, limits, warm)
    first_s = next(plans).makespan
    in_force_s = time.process_time() - begun_s
    later_s = min((plan.makespan for plan in plans), default=first_s)
    return in_force_s, read_s, first_s, later_s


def first_of_each(steps: list[Step]) -> Iterator[Step]:
    """The first step of each robot."""
    known = set()
    for step in steps:
        if step.arguments[0] not in known:
            known.add(step.arguments[0])
            yield step


def reached(text: str, plan: Plan, step: Step) -> News:
    """A robot has just explored its first target; the others are where they were."""
    robot, target = step.arguments[0], step.arguments[-1]
    before = [one for one in plan.steps if one.arguments[0] == robot and one.start <= step.start]
    start = before[0].arguments[1]
    text = text.replace(f"(at {robot} {start})", f"(at {robot} {target}) (explored {target})", 1)
    goal = rf"(\(:goal.*?)\(explored {re.escape(target)}\)"
    text = re.sub(goal, r"\1", text, flags=re.DOTALL)
    return News("a target is reached", text, without(plan, before))


def without(plan: Plan, done: list[Step]) -> Plan:
    """The plan without these steps."""
    steps = tuple(step for step in plan.steps if step not in done)
    return Plan(steps, plan.domain, plan.problem)


def blocked(text: str, plan: Plan, step: Step) -> News:
    """Before the step's target lies a blockade that nobody knew of, on whichever way one comes."""
    target = step.arguments[-1]
    name = "blockade-new"
    ways = rf"\(reachable (\S+) {target}\)|\(reachable {target} (\S+)\)"
    near = {one or other for one, other in re.findall(ways, text)}
    text = re.sub(ways, "", text)
    facts = [f"(= (blockade-size {name}) {SIZE_S})"]
    facts += [f"(reachable {place} {name}) (reachable {name} {place})" for place in sorted(near)]
    facts.append(f"(reachable {target} {name}) (reachable {name} {target})")
    least_s: dict[str, float] = {}
    costs = rf"\(= \(path-cost (\S+) (\S+) {target}\) ([\d.]+)\)"
    for robot, place, cost in re.findall(costs, text):
        if place in near:
            way_s = float(cost)
            least_s[robot] = min(way_s, least_s.get(robot, way_s))
            for one, other in ((place, name), (name, place)):
                facts.append(f"(= (path-cost {robot} {one} {other}) {BEFORE_TARGET * way_s:.0f})")
    for robot, way_s in least_s.items():
        for one, other in ((target, name), (name, target)):
            rest_s = (1 - BEFORE_TARGET) * way_s
            facts.append(f"(= (path-cost {robot} {one} {other}) {rest_s:.0f})")
    text = text.replace("- blockade", f"{name} - blockade", 1)
    text = text.replace("(:init", "(:init " + " ".join(facts), 1)
    return News("a blockade appears before a target", text, plan)
