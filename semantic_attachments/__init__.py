"""Semantic attachments: what a module call of PDDL/M means in a known world.

Source: Dornhege et al., "Semantic attachments for domain-independent planning systems", ICAPS 2009.
"""

from semantic_attachments.contract import (
    Attachment,
    EvaluationError,
    Evaluator,
    Kind,
    Memory,
    Parameter,
    Purity,
    Quality,
    StateView,
)
from semantic_attachments.registry import BindingError, bind
from semantic_attachments.world import Blockade, GridMap, Location, RobotModel, World

__all__ = [
    "Attachment",
    "BindingError",
    "Blockade",
    "EvaluationError",
    "Evaluator",
    "GridMap",
    "Kind",
    "Location",
    "Memory",
    "Parameter",
    "Purity",
    "Quality",
    "RobotModel",
    "StateView",
    "World",
    "bind",
]
