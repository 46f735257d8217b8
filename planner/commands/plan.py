"""`marsupial plan`: solves a problem, writes the plan as text, JSON, SVG or HTML."""

import json
import sys
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

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
    ARIES = "aries"
    LPG = "lpg"
    KAIROS = "kairos"


def plan_command(provider: AttachmentProvider | None = None) -> Callable[..., None]:
    """The command, with attachments from `provider`."""

    def plan(
        domain: Annotated[Path, typer.Argument(help="PDDL domain file.")],
        problem: Annotated[Path, typer.Argument(help="PDDL problem file.")],
        *,
        timeout: Annotated[
            float, typer.Option(help="Seconds to search, 0 for no limit.", min=0)
        ] = 10.0,
        cpu_timeout: Annotated[
            float | None,
            typer.Option(help="CPU seconds of this process, counted from its start.", min=0),
        ] = None,
        plan_file: Annotated[
            Path | None, typer.Option(help="Write improving plans as FILE.1, FILE.2, ...")
        ] = None,
        map: Annotated[  # noqa: A002 the option's name
            Path | None, typer.Option(help="Map (ROS map_server YAML) for path costs.")
        ] = None,
        seed: Annotated[int, typer.Option(help="Seed of all random choices.", min=0)] = 0,
        threads: Annotated[int, typer.Option(help="Threads that search.", min=1)] = 1,
        node_limit: Annotated[
            int | None, typer.Option(help="Stop after so many states and schedules.", min=1)
        ] = None,
        memory_limit: Annotated[int | None, typer.Option(help="MiB to search with.", min=1)] = None,
        first: Annotated[bool, typer.Option("--first", help="Stop at the first plan.")] = False,
        json_file: Annotated[
            Path | None, typer.Option("--json", help="Write all plans and statistics as JSON.")
        ] = None,
        svg: Annotated[Path | None, typer.Option(help="Write the best plan as SVG.")] = None,
        html: Annotated[Path | None, typer.Option(help="Write the best plan as a page.")] = None,
        watch: Annotated[
            bool, typer.Option("--watch", help="Show every improving plan as it is found.")
        ] = False,
        engine: Annotated[
            Engine, typer.Option(help="Who plans; others than marsupial are optional extras.")
        ] = Engine.MARSUPIAL,
    ) -> None:
        """Solve a PDDL problem and print the best plan.

        Exit codes: 0 plan found and done, 1-3 plan found and then a limit hit (1 memory or nodes,
        2 time, 3 stopped), 11 unsolvable, 12 exhausted, 20-24 stopped or limit hit without a
        plan, 30-36 faults.
        """
        with told():
            limits = Limits(
                timeout or None, seed, threads, node_limit, memory_limit, first, cpu_timeout
            )
            parsed = read_problem(read_domain(domain), problem)
            attachments = provided(provider, parsed, map)
            for path in (plan_file, svg, html, json_file):
                if path is not None:
                    path.parent.mkdir(parents=True, exist_ok=True)
            if engine is not Engine.MARSUPIAL:
                from planner.peers import solve_with_peer

                result = solve_with_peer(engine.value, parsed, attachments, limits.timeout_s)
            else:
                result = _search(parsed, attachments, limits, plan_file, watch)
            _write(result, parsed, seed=seed, json_file=json_file, svg=svg, html=html)
        if result.plan is None:
            sys.stderr.write(f"no plan: {result.outcome.row.meaning}\n")
        raise typer.Exit(result.outcome.row.exit_code)

    return plan


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


def _write(
    result: Result,
    problem: Problem,
    *,
    seed: int,
    json_file: Path | None,
    svg: Path | None,
    html: Path | None,
) -> None:
    """Writes the best plan to stdout and the files asked for."""
    if result.plan is not None:
        sys.stdout.write(result.plan.to_text())
        sys.stdout.flush()
    chart = result.plan or Plan((), problem.domain.name, problem.name)
    if svg is not None:
        svg.write_text(gantt.svg(chart))
    if html is not None:
        html.write_text(gantt.html(chart))
    if json_file is not None:
        json_file.write_text(json.dumps(report(result, seed), indent=1) + "\n")


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


plan = plan_command()
"""The command for domains without modules."""
