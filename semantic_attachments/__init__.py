"""Semantic attachments: what a module call of PDDL/M means in a known world.

Source: Dornhege et al., "Semantic attachments for domain-independent planning systems", ICAPS 2009.
"""

from semantic_attachments.contract import (
    Attachment,
    AttachmentError,
    Evaluator,
    Kind,
    Memory,
    Parameter,
    Purity,
    Quality,
)
from semantic_attachments.registry import bind
from semantic_attachments.world import Blockade, GridMap, Location, RobotModel, World

__all__ = [
    "Attachment",
    "AttachmentError",
    "Blockade",
    "Evaluator",
    "GridMap",
    "Kind",
    "Location",
    "Memory",
    "Parameter",
    "Purity",
    "Quality",
    "RobotModel",
    "World",
    "bind",
]
