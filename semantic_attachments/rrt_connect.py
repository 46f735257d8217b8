"""OMPL's RRT-Connect between two sets of poses, within a time.

Source: Kuffner and LaValle, "RRT-Connect: An efficient approach to single-query path planning",
ICRA 2000.
"""

from collections.abc import Sequence

from semantic_attachments.motion_space import MotionSpace, solution
from semantic_attachments.steering import Pose


def connect(
    space: MotionSpace, starts: Sequence[Pose], goals: Sequence[Pose], budget_s: float
) -> list[Pose]:
    """Poses of a motion from one of the starts to one of the goals that steering joins; none if
    none is found."""
    from ompl import geometric

    # Two headings of each end, opposite ones, are enough: others are reached from there.
    trials = [(ends[0], ends[len(ends) // 2]) for ends in (starts, goals)]
    for start, goal in zip(*trials, strict=True):
        definition = space.problem(start, goal)
        planner = geometric.RRTConnect(space.information)
        planner.setProblemDefinition(definition)
        planner.setup()
        planner.solve(budget_s / 2)
        if found := solution(definition):
            return found
    return []
