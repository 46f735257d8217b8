"""Geometry as numeric fluents, so that a problem's text carries all that its attachments need."""

from domains.mission_state import PositionM
from domains.pddl_text import ProblemText
from semantic_attachments.world import RobotModel


def write_location(
    text: ProblemText, identifier: str, type_name: str, position_m: PositionM
) -> None:
    """Declares a location and its position in the map frame [m]."""
    text.add_object(identifier, type_name)
    text.fluent("x", identifier, value=position_m[0])
    text.fluent("y", identifier, value=position_m[1])


def write_robot(text: ProblemText, identifier: str, type_name: str, model: RobotModel) -> None:
    """Declares a robot, its speed [m/s] and its radius [m]."""
    text.add_object(identifier, type_name)
    text.fluent("speed", identifier, value=model.speed_m_s)
    text.fluent("radius", identifier, value=model.radius_m)
