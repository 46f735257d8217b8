"""All strategies by the name that a mission asks for."""

from collections.abc import Mapping

from service.coordination.hungarian import HungarianDisaster
from service.coordination.strategy import Strategy
from service.coordination.temporal import TemporalPlanning

STRATEGIES: Mapping[str, Strategy] = {
    "hungarian": HungarianDisaster(),
    "planner": TemporalPlanning(),
}
