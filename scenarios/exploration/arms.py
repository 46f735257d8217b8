"""The strategies that are compared, by name."""

from __future__ import annotations

from collections.abc import Callable

from scenarios.exploration.buildings import Building
from service.coordination.exploration.cost_based import HungarianCosts, NearestFrontier
from service.coordination.exploration.greedy_utility import GreedyUtility
from service.coordination.exploration.idle_explorers import IdleExplorers
from service.coordination.exploration.segment_assignment import (
    SegmentAssignment,
    SegmentParameters,
)
from service.coordination.exploration.strategy import Exploring
from service.coordination.one_step_disaster import OneStepDisaster
from service.coordination.segmentation.segmentation import THESIS
from service.coordination.strategy import Strategy
from service.coordination.temporal import TemporalPlanning


def _by_hand(building: Building, parameters: SegmentParameters) -> Strategy:
    rooms = building.rooms
    if rooms is None:
        raise ValueError(f"{building.name} has no segmentation by hand")
    return Exploring(SegmentAssignment(parameters, labels=lambda _: rooms), "segments by hand")


def _planner() -> Strategy:
    return IdleExplorers(TemporalPlanning(fallback=OneStepDisaster()))


TO_THE_LETTER = SegmentParameters(spread=False, segmentation=THESIS)
"""Algorithms 1 and 2 and both constraints of 2.4.3."""

ARMS: dict[str, Callable[[Building], Strategy]] = {
    "nearest": lambda _: Exploring(NearestFrontier(), "nearest frontier"),
    "hungarian": lambda _: Exploring(HungarianCosts(), "Hungarian costs"),
    "greedy": lambda _: Exploring(GreedyUtility(), "greedy utility"),
    "segments": lambda _: Exploring(SegmentAssignment(), "segments"),
    "segments by hand": lambda building: _by_hand(building, SegmentParameters()),
    "segments, thesis": lambda _: Exploring(SegmentAssignment(TO_THE_LETTER), "segments, thesis"),
    "segments, even": lambda _: Exploring(
        SegmentAssignment(SegmentParameters(spread=False)), "segments, evenly"
    ),
    "planner": lambda _: _planner(),
}
"""`nearest` is the baseline of the thesis; `segments, even` is Algorithm 2 to the letter for teams
larger than the number of segments."""
