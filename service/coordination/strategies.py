"""All strategies by the name that a mission asks for."""

from collections.abc import Mapping

from service.coordination.hungarian import Hungarian, HungarianDisaster
from service.coordination.hungarian_marsupial import HungarianMarsupial
from service.coordination.strategy import Strategy
from service.coordination.temporal import TemporalPlanning


def all_strategies() -> Mapping[str, Strategy]:
    """Every strategy; a new one is a file and a line here."""
    hungarian = Hungarian({"disaster": HungarianDisaster(), "marsupial": HungarianMarsupial()})
    return {"hungarian": hungarian, "planner": TemporalPlanning(fallback=hungarian)}
