"""Where the commands get attachments from: rooms above the planner hand in a provider."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeAlias

from planner._core import Domain, Problem
from planner.attachments import Attachment
from planner.reading import InputError

AttachmentProvider: TypeAlias = Callable[[Domain, Problem, Path | None], Mapping[str, Attachment]]
"""Attachments for the modules of a domain, in the world of a problem and a map (YAML), if given."""


def provided(
    provider: AttachmentProvider | None, problem: Problem, map_path: Path | None
) -> Mapping[str, Attachment]:
    """The attachments that a problem needs; raises `InputError` where nobody provides them."""
    modules = problem.domain.modules
    if not modules:
        return {}
    if provider is None:
        names = ", ".join(f"[{module.name}]" for module in modules)
        raise InputError(
            f"the domain {problem.domain.name} calls {names}, and nothing here provides them: "
            "use the marsupial command, or planner.solve(attachments=...)"
        )
    return provider(problem.domain, problem, map_path)
