"""`marsupial compile-attachments`: plain PDDL 2.1 with the attachments' values as fluents."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from planner.commands.faults import told
from planner.commands.providers import AttachmentProvider, provided
from planner.compile_attachments import compile_attachments
from planner.reading import read_domain, read_problem


def compile_attachments_command(
    provider: AttachmentProvider | None = None,
) -> Callable[..., None]:
    """The command, with attachments from `provider`."""

    def compile_attachments_(
        domain: Annotated[Path, typer.Argument(help="PDDL/M domain file.")],
        problem: Annotated[Path, typer.Argument(help="PDDL problem file.")],
        folder: Annotated[Path, typer.Argument(help="Where domain.pddl and problem.pddl go.")],
        *,
        map: Annotated[  # noqa: A002 the option's name
            Path | None, typer.Option(help="Map (ROS map_server YAML) for path costs.")
        ] = None,
    ) -> None:
        """Write a domain and problem that planners without attachments can read."""
        with told():
            parsed = read_problem(read_domain(domain), problem)
            compiled = compile_attachments(parsed, provided(provider, parsed, map))
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "domain.pddl").write_text(compiled.domain)
            (folder / "problem.pddl").write_text(compiled.problem)
        sys.stdout.write(f"{folder / 'domain.pddl'}\n{folder / 'problem.pddl'}\n")

    return compile_attachments_


compile_attachments_plainly = compile_attachments_command()
"""The command for domains without modules."""
