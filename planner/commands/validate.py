"""`marsupial validate`: checks a plan, step by step if asked."""

import json
import sys
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from planner.commands.faults import told
from planner.commands.providers import AttachmentProvider, provided
from planner.reading import read_domain, read_plan, read_problem
from planner.validation import Verdict
from planner.validation import validate as check

INVALID = 1
"""Exit code for a plan that is not valid."""


def validate_command(provider: AttachmentProvider | None = None) -> Callable[..., None]:
    """The command, with attachments from `provider`."""

    def validate(
        domain: Annotated[Path, typer.Argument(help="PDDL domain file.")],
        problem: Annotated[Path, typer.Argument(help="PDDL problem file.")],
        plan: Annotated[Path, typer.Argument(help="Plan file, `0.0: (a b) [5.0]` a line.")],
        *,
        tolerance: Annotated[
            float,
            typer.Option("-t", "--tolerance", help="Seconds durations may be off by.", min=0),
        ] = 0.001,
        separation: Annotated[
            float,
            typer.Option(help="Seconds that interfering happenings must be apart.", min=0),
        ] = 0.0,
        verbose: Annotated[
            bool, typer.Option("-v", "--verbose", help="Tell every check and change.")
        ] = False,
        map: Annotated[  # noqa: A002 the option's name
            Path | None, typer.Option(help="Map (ROS map_server YAML) for path costs.")
        ] = None,
        json_file: Annotated[
            Path | None, typer.Option("--json", help="Write the verdict as JSON.")
        ] = None,
    ) -> None:
        """Check a plan: valid with makespan and metric, or the first thing that is wrong.

        Exit codes: 0 valid, 1 not valid, 31 a file that cannot be read, 33 an attachment failed.
        """
        with told():
            parsed = read_problem(read_domain(domain), problem)
            steps = read_plan(parsed, plan)
            verdict = check(
                parsed.domain,
                parsed,
                steps,
                attachments=provided(provider, parsed, map),
                tolerance_s=tolerance,
                separation_s=separation,
                report=verbose,
            )
            if json_file is not None:
                json_file.write_text(json.dumps(asdict(verdict), indent=1) + "\n")
        sys.stdout.write(as_text(verdict))
        raise typer.Exit(0 if verdict.valid else INVALID)

    return validate


def as_text(verdict: Verdict) -> str:
    """The report, if there is one, and the verdict."""
    lines = list(verdict.report)
    if verdict.valid:
        lines.append(f"Plan valid, makespan {verdict.makespan:.3f}")
        if verdict.metric is not None:
            lines.append(f"Metric: {verdict.metric:g}")
    else:
        lines.append("Plan invalid")
        lines.append(verdict.message or "")
    return "\n".join(lines) + "\n"


validate = validate_command()
"""The command for domains without modules."""
