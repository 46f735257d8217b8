"""How soon a plan is in force again after a target was reached."""

from __future__ import annotations

import re
import time
from pathlib import Path

from planner import Plan, Step, read_domain, read_problem, solve
from scenarios.benchmarks._markdown import table

HOSPITAL = Path("../shared/data/instances/disaster/d07-3x2-t15-b18.pddl")


def run(*, quick: bool) -> str:
    """First plan with and without a warm start at hospital size; empty where the file is absent."""
    if not HOSPITAL.is_file():
        return ""
    domain = read_domain(HOSPITAL.with_name("domain.pddl"))
    text = HOSPITAL.read_text(encoding="utf-8")
    problem = read_problem(domain, text)
    plan = solve(domain, problem, timeout_s=1.0 if quick else 5.0).plan
    if plan is None:
        return "No plan at hospital size."
    reached = next(step for step in plan.steps if step.action.startswith("explore"))
    later = read_problem(domain, _after(text, reached))
    rest = _rest(plan, reached)
    rows = []
    for title, warm in (("cold", None), ("warm", rest)):
        wall_s, makespan = min(_first_plan(domain, later, warm) for _ in range(3 if quick else 9))
        rows.append([title, f"{1000 * wall_s:.1f}", f"{makespan:.2f}"])
    title = "Replan at hospital size after one target is reached"
    return table(title, ["start", "valid plan after [ms]", "its makespan"], rows)


def _first_plan(domain: object, problem: object, warm: Plan | None) -> tuple[float, float]:
    begun = time.process_time()
    result = solve(domain, problem, warm_start=warm, first_plan_only=True, timeout_s=10)  # type: ignore[arg-type]
    spent_s = time.process_time() - begun
    return spent_s, result.plan.makespan if result.plan else float("inf")


def _after(text: str, step: Step) -> str:
    """The problem when a robot has just explored its target; the others are where they were."""
    robot, start, target = step.arguments[0], step.arguments[1], step.arguments[-1]
    text = text.replace(f"(at {robot} {start})", f"(at {robot} {target}) (explored {target})", 1)
    return re.sub(rf"(\(:goal.*?)\(explored {re.escape(target)}\)", r"\1", text, flags=re.DOTALL)


def _rest(plan: Plan, done: Step) -> Plan:
    steps = tuple(step for step in plan.steps if step is not done)
    return Plan(steps, plan.domain, plan.problem)
