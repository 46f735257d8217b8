"""Assignment of robots to segments of the map (Wurm, section 2.5, Algorithm 2)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.world import GridMap
from service.coordination.assignment import hungarian
from service.coordination.exploration.problem import ExplorationProblem
from service.coordination.exploration.unknown_ahead import unknown_ahead
from service.coordination.segmentation.segmentation import SegmentationParameters, segment_labels

Labels = NDArray[np.int32]


@dataclass(frozen=True)
class SegmentParameters:
    """How robots are distributed over segments."""

    discount: float = 0.5
    """Factor on the cost of the segment that a robot is in."""
    spread: bool = True
    """Whether a team larger than the number of segments is distributed by how much unknown space
    lies within sensor range of them, instead of evenly."""
    segmentation: SegmentationParameters = field(default_factory=SegmentationParameters)


@dataclass(frozen=True)
class SegmentAssignment:
    """Robots to segments first, then to targets inside their segment."""

    parameters: SegmentParameters = field(default_factory=SegmentParameters)
    labels: Callable[[GridMap], Labels] | None = None
    """A segmentation made by other means, for instance by hand; (rows, columns), 0 for none."""

    def assign(self, problem: ExplorationProblem) -> Mapping[int, int]:
        """Algorithm 2 on the segmentation of the map."""
        # 1: determine a segmentation
        labels = self._segmentation(problem.grid)
        # 2 to 4: exploration targets of each segment
        segment_of_target = labels.ravel()[problem.target_cells]
        work = None
        if self.parameters.spread and len(problem.robot_cells) > len(np.unique(segment_of_target)):
            range_cells = problem.sensor_range_m / problem.grid.resolution_m
            work = unknown_ahead(problem.grid, labels, range_cells)
        return assign_by_segment(
            problem.costs_s,
            segment_of_target,
            labels.ravel()[problem.robot_cells],
            self.parameters.discount,
            work,
        )

    def _segmentation(self, grid: GridMap) -> Labels:
        if self.labels is not None:
            return self.labels(grid)
        return segment_labels(grid.cells, grid.resolution_m, self.parameters.segmentation)


def assign_by_segment(
    costs_s: NDArray[np.float64],
    segment_of_target: NDArray[np.int32],
    segment_of_robot: NDArray[np.int32],
    discount: float,
    work: NDArray[np.int64] | None = None,
) -> dict[int, int]:
    """Lines 5 to 15 of Algorithm 2: target of each robot, by index.

    With one segment this is the Hungarian assignment by costs alone.

    Args:
        costs_s: (robots, targets); infinite where a robot cannot go.
        discount: factor on a robot's cost of the segment it is in.
        work: how much there is to do in each segment, by number; a team that is larger than the
            number of segments is distributed in proportion. Evenly if not given.
    """
    robots, targets = costs_s.shape
    if not robots or not targets:
        return {}
    segments = np.unique(segment_of_target)
    members = [np.flatnonzero(segment_of_target == number) for number in segments]
    # 5 to 9: cost of the nearest target in each segment, less where the robot is already
    costs = np.stack([costs_s[:, of].min(axis=1) for of in members], axis=1)
    costs *= np.where(segment_of_robot[:, None] == segments[None, :], discount, 1.0)
    # 10: robots to segments
    able = np.flatnonzero(np.isfinite(costs).any(axis=1)).tolist()
    if not able:
        return {}
    slots = _slots(len(able), segments, work)
    by_slot = hungarian(costs[able][:, slots].tolist())
    segment_of = {able[row]: slots[slot] for row, slot in by_slot.items()}
    for robot in able:
        # Where others have taken all the places it can get to, it joins them.
        segment_of.setdefault(robot, int(np.argmin(costs[robot])))
    # 11 to 15: robots to targets inside each segment
    chosen: dict[int, int] = {}
    for index, targets_here in enumerate(members):
        here = [robot for robot in able if segment_of[robot] == index]
        if here:
            local = hungarian(costs_s[here][:, targets_here].tolist(), share=True)
            chosen |= {here[row]: int(targets_here[column]) for row, column in local.items()}
    return dict(sorted(chosen.items()))


def _slots(robots: int, segments: NDArray[np.int32], work: NDArray[np.int64] | None) -> list[int]:
    """Index of the segment of each place that a robot can take.

    One place a segment, and for a larger team as many more as there are robots, in proportion to
    the work (highest averages, Jefferson's method): no segment gets a second robot before each has
    its first.
    """
    slots = list(range(len(segments)))
    share = np.ones(len(segments))
    if work is not None:
        share = np.maximum(work[segments].astype(np.float64), 1.0)
    places = np.ones(len(segments))
    while len(slots) < robots:
        index = int(np.argmax(share / (places + 1.0)))
        places[index] += 1
        slots.append(index)
    return slots
