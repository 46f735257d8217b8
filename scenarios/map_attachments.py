"""Attachments of a problem whose world is on a map: what `--map` gives the planner's commands."""

from collections.abc import Mapping
from pathlib import Path

from planner import Attachment, Domain, InputError, Problem


def map_attachments(
    domain: Domain, problem: Problem, map_path: Path | None
) -> Mapping[str, Attachment]:
    """Binds the modules of a domain to the world of a problem on a map."""
    if map_path is None:
        names = ", ".join(f"[{module.name}]" for module in domain.modules)
        raise InputError(
            f"the domain {domain.name} calls {names}: give the map they work on, --map MAP.yaml"
        )
    from semantic_attachments import bind
    from semantic_attachments.map_server import read_map
    from semantic_attachments.problem_world import world_of_problem
    from semantic_attachments.registry import BindingError

    try:
        return bind(domain, world_of_problem(problem, read_map(map_path)))
    except (BindingError, ValueError) as error:
        raise InputError(str(error)) from error
