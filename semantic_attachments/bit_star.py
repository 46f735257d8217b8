"""OMPL's BIT* looks for a shorter motion than one that is known, within a time.

Source: Gammell, Srinivasa and Barfoot, "Batch Informed Trees (BIT*): Sampling-based optimal
planning via the heuristically guided search of implicit random geometric graphs", ICRA 2015. Its
trees grow from both ends, so robots that cannot drive backwards get RRT* instead: Karaman and
Frazzoli, "Sampling-based algorithms for optimal motion planning", IJRR 30(7), 2011.
"""

from semantic_attachments.motion_space import MotionSpace, solution
from semantic_attachments.steering import Pose


def shortened(space: MotionSpace, poses: list[Pose], budget_s: float) -> list[Pose]:
    """A motion between the same ends, no longer than the given one."""
    from ompl import base, geometric

    definition = space.problem(poses[0], poses[-1])
    definition.setOptimizationObjective(base.PathLengthOptimizationObjective(space.information))
    both_ways = space.space.hasSymmetricDistance()
    planner = (geometric.BITstar if both_ways else geometric.RRTstar)(space.information)
    planner.setProblemDefinition(definition)
    planner.setup()
    planner.solve(budget_s)
    found = solution(definition)
    return found if found and space.length_m(found) < space.length_m(poses) else poses
