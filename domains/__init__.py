"""PDDL domains and how a mission is formulated in them: one folder a domain.

A folder holds `domain.pddl`, `formulation.py` (a module that defines `FORMULATION`), example
problems under
`problems/` with `expect.toml`, and a README. A new domain is a new folder; nothing has to be
registered.
"""

from domains.catalogue import UnknownDomainError, available, load
from domains.formulation import Assignment, Formulation
from domains.mission_state import (
    Activity,
    BlockadeState,
    MeetingPoint,
    MissionState,
    RobotState,
    Target,
)

__all__ = [
    "Activity",
    "Assignment",
    "BlockadeState",
    "Formulation",
    "MeetingPoint",
    "MissionState",
    "RobotState",
    "Target",
    "UnknownDomainError",
    "available",
    "load",
]
