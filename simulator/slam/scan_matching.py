"""Scan matching with covariance: correlative search for the basin, point-to-line for its bottom.

1. Correlative: the best pose of a window by branch and bound (Olson, ICRA 2009; Hess et al., ICRA
   2016), native, immune to local optima.
2. Point to line (Censi, "An ICP variant using a point-to-line metric", ICRA 2008), Gauss-Newton
   with Cauchy weights. Its normal matrix is the information of the match (Censi, "An Accurate
   Closed-Form Estimate of ICP's Covariance", ICRA 2007).
3. A direction that no surface stands across (a bare corridor's) has no information, whatever the
   noise of the normals pretends: it is taken out of the normal matrix (Zhang, Kaess and Singh, "On
   Degeneracy of Optimization-based State Estimation Problems", ICRA 2016), so that the odometry
   decides there. Without this, corridors shrink (thesis 4.5.5).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from simulator._core import LikelihoodField
from simulator.slam.pose import Points, Poses, between, compose, transform
from simulator.slam.range_scan import RangeScan, thinned


@dataclass(frozen=True, slots=True)
class ScanMatchParameters:
    """How a scan is matched."""

    resolution_m: float = 0.05
    """cells of the correlative search"""
    sigma_m: float = 0.08
    """width of a point's bump in the correlative search"""
    step_rad: float = 0.01
    spacing_m: float = 0.08
    """points of a scan are thinned to one in a square so wide"""
    least_score: float = 0.35
    """mean value per point, at most 1, below which a match does not count"""
    reach_m: float = 0.3
    """points farther from every reference point count for nothing in the refinement"""
    iterations: int = 12
    noise_m: float = 0.02
    """standard deviation of a point from its surface"""
    across: float = 0.3
    """sine of the least angle at which a surface tells of a direction"""
    least_across: int = 4
    """so many points have to lie on such surfaces"""
    debias: bool = True
    """whether directions that no surface stands across are left to the odometry"""
    floor: tuple[float, float, float] = (0.008, 0.008, 0.003)
    """standard deviations [m, m, rad] of what the model does not know, added to the covariance"""


@dataclass(frozen=True, slots=True, eq=False)
class ScanMatch:
    """Where a scan was taken, in the reference's frame."""

    pose: Poses
    """(3,)"""
    information: NDArray[np.float64]
    """(3, 3), in the frame of the pose; singular where the scan tells nothing"""
    score: float
    """share of the scan's points that lie near a reference point"""


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """Points on surfaces with their normals: what a scan is matched to."""

    points_m: Points
    """(n, 2)"""
    normals: Points
    """(n, 2): unit vectors across the surface, zero where there is none"""
    tree: KDTree


def surfaces(scans: Sequence[tuple[Poses, RangeScan]], spacing_m: float = 0.05) -> Surfaces:
    """Points of several scans, each seen from its pose, in one frame, one a square of the spacing.

    Raises:
        ValueError: no beam of any scan met anything.
    """
    parts = [transform(pose, scan.points()) for pose, scan in scans]
    points = np.concatenate(parts) if parts else np.zeros((0, 2))
    if len(points) == 0:
        raise ValueError("scans in which no beam met anything cannot be matched")
    points = thinned(points, spacing_m)
    tree = KDTree(points)
    return Surfaces(points, _normals(points, tree), tree)


def _normals(points: Points, tree: KDTree, count: int = 9, reach_m: float = 0.25) -> Points:
    """(n, 2): normals of lines fitted to the nearest points."""
    count = min(count, len(points))
    found = tree.query(points, count, distance_upper_bound=reach_m)
    distances = np.asarray(found[0]).reshape(len(points), -1)
    neighbours = np.asarray(found[1]).reshape(len(points), -1)
    near = np.isfinite(distances)
    weights = near / np.maximum(near.sum(axis=1, keepdims=True), 1)
    around = points[np.minimum(neighbours, len(points) - 1)]
    centred = around - np.einsum("nk,nkd->nd", weights, around)[:, None]
    spread = np.einsum("nk,nki,nkj->nij", weights, centred, centred)
    values, vectors = np.linalg.eigh(spread)
    flat = (near.sum(axis=1) >= 4) & (values[:, 0] < 0.1 * values[:, 1])
    return np.where(flat[:, None], vectors[:, :, 0], 0.0)


def match(
    reference: Surfaces,
    scan: RangeScan,
    guess: Poses,
    window: tuple[float, float],
    parameters: ScanMatchParameters | None = None,
    *,
    prior: NDArray[np.float64] | None = None,
) -> ScanMatch | None:
    """Finds the pose of a scan near a guess.

    Args:
        reference: what is known already.
        scan: what was seen.
        guess: (3,) in the reference's frame.
        window: how far from the guess to look [m], [rad]; zeros leave out the search.
        parameters: see there.
        prior: (3, 3) information of the guess, as of odometry; it decides where the scan does not.

    Returns:
        None if nothing in the window fits well enough.
    """
    parameters = parameters or ScanMatchParameters()
    points = scan.points(parameters.spacing_m)
    if len(points) < 10:
        return None
    pose = guess
    if window[0] > 0.0:
        near = _around(reference.points_m, guess, scan.range_m + window[0])
        if len(near) == 0:
            return None
        field = LikelihoodField.around_points(near, parameters.resolution_m, parameters.sigma_m)
        found = field.match(
            points,
            (float(guess[0]), float(guess[1]), float(guess[2])),
            (window[0], window[1], parameters.step_rad),
            parameters.least_score,
        )
        if found is None:
            return None
        pose = np.array(found[0])
        if prior is not None:
            if parameters.debias:
                pose = _slide_back(reference, points, pose, guess, parameters)
            # Odometry that a scan contradicts clearly was wrong: wheels slip, clocks differ.
            apart = between(guess, pose)
            prior = prior / max(1.0, float(apart @ prior @ apart) / 9.0)
    return refine(reference, points, pose, parameters, guess=guess, prior=prior)


def _around(points: Points, centre: Poses, reach_m: float) -> Points:
    inside = np.all(np.abs(points - centre[:2]) < reach_m, axis=1)
    return points[inside]


def _slide_back(
    reference: Surfaces,
    points: Points,
    pose: Poses,
    guess: Poses,
    parameters: ScanMatchParameters,
) -> Poses:
    """Undoes the search's step in a direction that the scan tells nothing about."""
    normals, _, _, _ = _correspondences(reference, points, pose, parameters.reach_m)
    blind = _blind_direction(normals, parameters)
    if blind is None:
        return pose
    back = blind * float(blind @ (guess[:2] - pose[:2]))
    return np.array([pose[0] + back[0], pose[1] + back[1], pose[2]])


def refine(
    reference: Surfaces,
    points: Points,
    pose: Poses,
    parameters: ScanMatchParameters,
    *,
    guess: Poses | None = None,
    prior: NDArray[np.float64] | None = None,
) -> ScanMatch | None:
    """Gauss-Newton on the distances of points (n, 2) from the reference's surfaces."""
    prior = np.zeros((3, 3)) if prior is None else prior
    guess = pose if guess is None else guess
    normal_matrix, share = np.zeros((3, 3)), 0.0
    for iteration in range(parameters.iterations):
        reach_m = parameters.reach_m if iteration < 4 else 0.5 * parameters.reach_m
        normals, offsets, used, share = _correspondences(reference, points, pose, reach_m)
        if len(normals) < 10:
            return None
        # Residuals n.(q - p); derivatives by a step (x, y, heading) in the pose's own frame.
        cosine, sine = np.cos(pose[2]), np.sin(pose[2])
        own = normals @ np.array([[cosine, -sine], [sine, cosine]])
        arm = points[used]
        jacobian = np.stack(
            [own[:, 0], own[:, 1], own[:, 1] * arm[:, 0] - own[:, 0] * arm[:, 1]], axis=1
        )
        scale = 2.0 * parameters.noise_m
        weights = 1.0 / (1.0 + (offsets / scale) ** 2)
        weighted = jacobian * weights[:, None]
        normal_matrix = weighted.T @ jacobian / parameters.noise_m**2
        gradient = weighted.T @ offsets / parameters.noise_m**2
        if parameters.debias:
            keep = _informed(own, parameters)
            normal_matrix, gradient = keep @ normal_matrix @ keep, keep @ gradient
        away = between(pose, guess)
        step = np.linalg.solve(normal_matrix + prior + 1e-6 * np.eye(3), gradient + prior @ away)
        pose = compose(pose, step)
        if np.all(np.abs(step) < (1e-4, 1e-4, 1e-5)) and iteration >= 4:
            break
    return ScanMatch(pose, _with_floor(normal_matrix, parameters.floor), share)


def _correspondences(
    reference: Surfaces, points: Points, pose: Poses, reach_m: float
) -> tuple[Points, NDArray[np.float64], NDArray[np.intp], float]:
    """Normals (m, 2) and offsets (m,) to the nearest surfaces, of the points with indices (m,).

    Last the share of the points that have a reference point within reach.
    """
    seen = transform(pose, points)
    found = reference.tree.query(seen, distance_upper_bound=reach_m)
    distances, nearest = np.asarray(found[0]), np.asarray(found[1])
    near = np.flatnonzero(np.isfinite(distances))
    normals = reference.normals[nearest[near]]
    on_surface = np.any(normals != 0.0, axis=1)
    used = near[on_surface]
    normals = normals[on_surface]
    apart = reference.points_m[nearest[used]] - seen[used]
    return normals, np.einsum("nd,nd->n", normals, apart), used, len(near) / len(points)


def _blind_direction(
    normals: Points, parameters: ScanMatchParameters
) -> NDArray[np.float64] | None:
    """(2,): the direction of which the surfaces tell nothing, if there is one."""
    if len(normals) == 0:
        return None
    _, vectors = np.linalg.eigh(normals.T @ normals)
    weak = vectors[:, 0]
    across = int(np.count_nonzero(np.abs(normals @ weak) > parameters.across))
    return weak if across < parameters.least_across else None


def _informed(normals: Points, parameters: ScanMatchParameters) -> NDArray[np.float64]:
    """(3, 3): projection onto the directions of x, y and heading that the surfaces tell about."""
    keep = np.eye(3)
    weak = _blind_direction(normals, parameters)
    if weak is not None:
        keep[:2, :2] -= np.outer(weak, weak)
    return keep


def _with_floor(
    information: NDArray[np.float64], floor: tuple[float, float, float]
) -> NDArray[np.float64]:
    """(3, 3): information of an estimate with an independent error on top, also if singular.

    (I^-1 + F)^-1 = I - I (I + F^-1)^-1 I, which needs no inverse of I.
    """
    extra = np.diag(1.0 / np.square(floor))
    reduced = information - information @ np.linalg.solve(information + extra, information)
    return np.asarray(0.5 * (reduced + reduced.T))
