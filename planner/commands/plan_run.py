"""Solves a problem as the command line asks and writes the plan as text, JSON, SVG or HTML."""

import json
import sys
import time
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any

from planner import _core, gantt
from planner._core import Problem
from planner.attachments import Attachments
from planner.commands.faults import told
from planner.commands.progress import Display
from planner.commands.providers import AttachmentProvider, provided
from planner.memory import peak_mb
from planner.outcome import Outcome
from planner.plan import Plan
from planner.reading import read_domain, read_problem
from planner.solving import Limits, Result, improving_plans


class Engine(StrEnum):
    """Who plans: marsupial, or a peer from an optional extra."""

    MARSUPIAL = "marsupial"
    TAMER = "tamer"
    TAMERLITE = "tamerlite"
    ARIES = "aries"
    LPG = "lpg"
    KAIROS = "kairos"


@dataclass(frozen=True, slots=True)
class Outputs:
    """Files that are written; None are not."""

    plan_file: Path | None = None
    """Improving plans as FILE.1, FILE.2, ..."""
    json_file: Path | None = None
    """All plans and statistics."""
    svg: Path | None = None
    """The best plan as a chart."""
    html: Path | None = None
    """The best plan as a page."""

    def make_folders(self) -> None:
        """Makes the folders of the files."""
        for path in (self.plan_file, self.json_file, self.svg, self.html):
            if path is not None:
                path.parent.mkdir(parents=True, exist_ok=True)


@dataclass(frozen=True, slots=True)
class PlanRequest:
    """What `marsupial plan` is asked."""

    domain: Path
    problem: Path
    map: Path | None = None
    """The map of the problem's world."""
    limits: Limits = field(default_factory=Limits)
    outputs: Outputs = field(default_factory=Outputs)
    watch: bool = False
    """Whether every improving plan is shown."""
    engine: Engine = Engine.MARSUPIAL


def run_plan(request: PlanRequest, provider: AttachmentProvider | None) -> int:
    """Plans; the exit code. Attachments come from `provider`."""
    limits, outputs = request.limits, request.outputs
    begun_s = time.monotonic()
    with told():
        parsed = read_problem(read_domain(request.domain), request.problem)
        attachments = provided(provider, parsed, request.map)
        outputs.make_folders()
        if request.engine is not Engine.MARSUPIAL:
            from planner.peers import solve_with_peer

            result = solve_with_peer(request.engine.value, parsed, attachments, limits.timeout_s)
        else:
            left = limits.since(begun_s)
            result = _search(parsed, attachments, left, outputs.plan_file, request.watch)
        _write(result, parsed, limits.seed, outputs)
    if result.plan is None:
        sys.stderr.write(f"no plan: {result.outcome.row.meaning}\n")
    return result.outcome.row.exit_code


def _search(
    problem: Problem,
    attachments: Attachments,
    limits: Limits,
    plan_file: Path | None,
    watch: bool,
) -> Result:
    """Runs our own search; writes every improving plan as soon as it is found."""
    display = Display(every_plan=watch)
    search = improving_plans(problem, attachments, limits, on_wait=display.progress)
    plans: list[Plan] = []
    try:
        while True:
            plan = next(search)
            plans.append(plan)
            if plan_file is not None:
                plan_file.with_name(f"{plan_file.name}.{len(plans)}").write_text(plan.to_text())
            display.plan(plan)
    except StopIteration as end:
        result: Result = end.value
        return result
    except KeyboardInterrupt:
        if not plans:
            raise
        return Result(Outcome.SOLVED_CANCELLED, tuple(plans))
    finally:
        display.close()


def _write(result: Result, problem: Problem, seed: int, outputs: Outputs) -> None:
    """Writes the best plan to stdout and the files asked for."""
    if result.plan is not None:
        sys.stdout.write(result.plan.to_text())
        sys.stdout.flush()
    chart = result.plan or Plan((), problem.domain.name, problem.name)
    if outputs.svg is not None:
        outputs.svg.write_text(gantt.svg(chart))
    if outputs.html is not None:
        outputs.html.write_text(gantt.html(chart))
    if outputs.json_file is not None:
        outputs.json_file.write_text(json.dumps(report(result, seed), indent=1) + "\n")


def report(result: Result, seed: int) -> dict[str, Any]:
    """The result as `--json` writes it."""
    statistics = result.statistics
    return {
        "outcome": result.outcome.value,
        "plans": [plan.to_json() for plan in result.plans],
        "lower_bound": result.lower_bound,
        "expansions": statistics.expansions,
        "evaluations": statistics.evaluations,
        "schedules": statistics.schedules,
        "cpu_s": statistics.cpu_s,
        "wall_s": statistics.wall_s,
        "peak_mb": peak_mb(),
        "version": _core.__version__,
        "seed": seed,
    }
