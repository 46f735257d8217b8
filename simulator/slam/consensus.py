"""Which of many alignment hypotheses hold together: RANSAC, and the largest consistent clique.

RANSAC (Fischler and Bolles 1981) is the thesis's choice: one rigid motion, and whoever agrees with
it. Pairwise consistency maximisation (Mangelson, Dominic, Eustice and Vasudevan, "Pairwise
Consistent Measurement Set Maximization for Robust Multi-Robot Map Merging", ICRA 2018) asks only
that hypotheses agree pair by pair, given how far each robot may have drifted between them: it keeps
both ends of a corridor that one of the maps shows too short. Neither wins everywhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from simulator.slam.clique import maximum_clique
from simulator.slam.pose import (
    Poses,
    between,
    compose,
    compose_jacobians,
    inverse,
    transform,
    wrap,
)

ConsensusMethod = Literal["ransac", "pcm"]


@dataclass(frozen=True, slots=True)
class RansacParameters:
    """One rigid motion for all hypotheses."""

    reach_m: float = 1.0
    """hypotheses that differ less at the place where they were made agree"""
    reach_rad: float = 0.12
    samples: int = 200


def ransac_motions(
    motions: Poses,
    places_m: NDArray[np.float64],
    random: np.random.Generator,
    parameters: RansacParameters | None = None,
) -> NDArray[np.intp]:
    """Indices of the largest set of hypotheses that one of them explains.

    Args:
        motions: (m, 3) hypotheses of the same motion.
        places_m: (m, 2) where each was made, in the frame that is moved.
        random: draws the hypotheses that are tried, all of them if they are few.
        parameters: see there.
    """
    parameters = parameters or RansacParameters()
    count = len(motions)
    if count == 0:
        return np.zeros(0, dtype=np.intp)
    if count <= parameters.samples:
        tried = np.arange(count)
    else:
        tried = np.sort(random.choice(count, parameters.samples, replace=False))
    targets = transform(motions, places_m[:, None])[:, 0]
    apart = np.linalg.norm(transform(motions[tried], places_m) - targets, axis=2)
    turned = np.abs(wrap(motions[tried, None, 2] - motions[None, :, 2]))
    agrees = (apart < parameters.reach_m) & (turned < parameters.reach_rad)
    return np.flatnonzero(agrees[int(np.argmax(agrees.sum(axis=1)))])


def largest_clique(consistent: NDArray[np.bool_], most: int = 400) -> NDArray[np.intp]:
    """Indices of the largest set in which every two are consistent.

    Sought among the `most` hypotheses that are consistent with most others.
    """
    degree = np.count_nonzero(consistent & consistent.T, axis=1)
    chosen = np.sort(np.argsort(-degree, kind="stable")[:most])
    return chosen[maximum_clique(consistent[np.ix_(chosen, chosen)])]


@dataclass(frozen=True, slots=True, eq=False)
class InterEdge:
    """A node of one robot as measured from a node of another: a constraint between graphs."""

    robot_a: str
    node_a: int
    robot_b: str
    node_b: int
    measurement: Poses
    """(3,): pose of node_b in the frame of node_a"""
    information: NDArray[np.float64]
    """(3, 3)"""


def pairwise_consistency(
    edges: Sequence[InterEdge],
    poses_a: Poses,
    poses_b: Poses,
    spread_a: NDArray[np.float64],
    spread_b: NDArray[np.float64],
    *,
    gate: float = 11.34,
) -> NDArray[np.bool_]:
    """(m, m): whether two constraints close a loop with the robots' own estimates.

    Args:
        edges: constraints between the same two robots.
        poses_a: (m, 3) each constraint's node of the first robot, in its own frame.
        poses_b: (m, 3) the same of the second robot.
        spread_a: (m, m, 3, 3) covariance of the relative pose of two nodes of the first robot.
        spread_b: (m, m, 3, 3) of the second robot.
        gate: squared Mahalanobis distance that still counts; 11.34 keeps 99 % of right pairs.
    """
    count = len(edges)
    measured = np.array([edge.measurement for edge in edges]).reshape(-1, 3)
    noise = np.array([np.linalg.inv(edge.information) for edge in edges]).reshape(-1, 3, 3)
    first, second = np.triu_indices(count, 1)
    # Around the loop: node a of the first edge, over its b, b of the second, and back to a.
    step_b = between(poses_b[first], poses_b[second])
    step_a = between(poses_a[second], poses_a[first])
    there = compose(measured[first], step_b)
    across = compose(there, inverse(measured[second]))
    error = compose(across, step_a)
    covariance = _loop_covariance(
        measured[first],
        step_b,
        measured[second],
        step_a,
        noise_one=noise[first],
        noise_other=noise[second],
    )
    covariance += _moved(spread_b[first, second], measured[first], step_b)
    covariance += spread_a[second, first]
    distance = np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[..., None])[..., 0])
    consistent = np.eye(count, dtype=np.bool_)
    consistent[first, second] = consistent[second, first] = distance < gate
    return consistent


def _loop_covariance(
    one: Poses,
    step_b: Poses,
    other: Poses,
    step_a: Poses,
    *,
    noise_one: NDArray[np.float64],
    noise_other: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(n, 3, 3): what the noise of the two constraints makes of the loop's error."""
    rest = compose(compose(step_b, inverse(other)), step_a)
    by_one, _ = compose_jacobians(one, rest)
    covariance = by_one @ noise_one @ np.swapaxes(by_one, 1, 2)
    # The second constraint is run through backwards: its noise, turned into the loop's end frame.
    start = compose(compose(one, step_b), inverse(other))
    by_inverse, _ = compose_jacobians(start, other)
    turn = compose_jacobians(start, step_a)[0] @ np.linalg.inv(by_inverse)
    _, by_other = compose_jacobians(start, other)
    back = turn @ by_other
    return np.asarray(covariance + back @ noise_other @ np.swapaxes(back, 1, 2))


def _moved(spread: NDArray[np.float64], one: Poses, step_b: Poses) -> NDArray[np.float64]:
    """(n, 3, 3): covariance of a step as seen from before the constraint that leads to it."""
    _, by_step = compose_jacobians(one, step_b)
    return np.asarray(by_step @ spread @ np.swapaxes(by_step, 1, 2))


def relative_spread(
    joint: NDArray[np.float64], poses: Poses, floor: Sequence[float] = (0.02, 0.02, 0.005)
) -> NDArray[np.float64]:
    """(m, m, 3, 3): covariance of the pose of one node in the frame of another.

    Args:
        joint: (3 m, 3 m) as of `back_end.joint_covariance`: blocks in the nodes' own frames.
        poses: (m, 3) the nodes.
        floor: standard deviations [m, m, rad] that no relative pose is known better than.
    """
    count = len(poses)
    blocks = joint.reshape(count, 3, count, 3).swapaxes(1, 2)
    relative = between(poses[:, None], poses[None])
    # A step of the start in its own frame moves the end in the start's frame against it.
    by_start = np.zeros((count, count, 3, 3))
    by_start[..., 0, 0] = by_start[..., 1, 1] = by_start[..., 2, 2] = -1.0
    by_start[..., 0, 2], by_start[..., 1, 2] = relative[..., 1], -relative[..., 0]
    cosine, sine = np.cos(relative[..., 2]), np.sin(relative[..., 2])
    by_end = np.zeros((count, count, 3, 3))
    by_end[..., 0, 0] = by_end[..., 1, 1] = cosine
    by_end[..., 0, 1], by_end[..., 1, 0] = -sine, sine
    by_end[..., 2, 2] = 1.0
    own = blocks[np.arange(count), np.arange(count)]
    cross = by_start @ blocks @ np.swapaxes(by_end, 2, 3)
    spread = (
        by_start @ own[:, None] @ np.swapaxes(by_start, 2, 3)
        + by_end @ own[None] @ np.swapaxes(by_end, 2, 3)
        + cross
        + np.swapaxes(cross, 2, 3)
    )
    return np.asarray(spread + np.diag(np.square(floor)))
