"""`marsupial plan`: solves a problem, writes the plan as text, JSON, SVG or HTML."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from planner.commands.faults import told
from planner.commands.plan_run import Engine, Outputs, PlanRequest, run_plan
from planner.commands.providers import AttachmentProvider
from planner.solving import Heuristic, Limits, Space


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
        heuristic: Annotated[
            Heuristic | None, typer.Option(help="What guides the decision-epoch search.")
        ] = None,
        space: Annotated[Space, typer.Option(help="Which spaces are searched.")] = Space.PORTFOLIO,
    ) -> None:
        """Solve a PDDL problem and print the best plan.

        Exit codes: 0 plan found and done, 1-3 plan found and then a limit hit (1 memory or nodes,
        2 time, 3 stopped), 11 unsolvable, 12 exhausted, 20-24 stopped or limit hit without a
        plan, 30-36 faults.
        """
        with told():
            request = PlanRequest(
                domain,
                problem,
                map,
                Limits(
                    timeout or None,
                    seed,
                    threads,
                    node_limit,
                    memory_limit,
                    first,
                    cpu_timeout,
                    heuristic,
                    space,
                ),
                Outputs(plan_file, json_file, svg, html),
                watch,
                engine,
            )
        raise typer.Exit(run_plan(request, provider))

    return plan


plan = plan_command()
"""The command for domains without modules."""
