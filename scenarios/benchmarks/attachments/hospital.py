"""The hospital example of the disaster domain: 15 targets, 18 blockades."""

from pathlib import Path

import domains
import planner
import scenarios
from semantic_attachments.map_server import read_map
from semantic_attachments.problem_world import world_of_problem
from semantic_attachments.world import World


def hospital_problem() -> planner.Problem:
    """The problem of the disaster domain."""
    folder = Path(domains.__file__).parent / "disaster"
    domain = planner.read_domain(folder / "domain.pddl")
    return planner.read_problem(domain, folder / "problems" / "hospital-15.pddl")


def hospital_world() -> World:
    """The world its attachments see."""
    maps = Path(scenarios.__file__).parent / "maps" / "hospital"
    return world_of_problem(hospital_problem(), read_map(maps / "hospital.yaml"))
