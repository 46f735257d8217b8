"""Triangles of landmarks and their invariant features (thesis 4.4.1, eq. 4.14-4.17, Algorithm 4).

Eq. 4.17 prints S = prod exp((f_a - f_b)^2), which grows with the difference of two triangles, and
eq. 4.16 keeps pairs with S < tau: a dissimilarity, though the text calls it a similarity. The
evident intent is implemented: S is 1 for congruent triangles, and S < tau is the same as a distance
of the features below sqrt(ln tau), which is what makes a search tree possible: O(n log n) instead
of all n^2 pairs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, KDTree, QhullError

from simulator.slam.pose import Points, Poses, wrap


@dataclass(frozen=True, slots=True)
class TriangleParameters:
    """Which triangles are compared, and when two of them correspond."""

    tau: float = 3.0
    """threshold of eq. 4.16 on the dissimilarity of eq. 4.17"""
    scale_m: float = 0.5
    """difference of perimeters (and of square roots of areas) that counts as one"""
    edge_tolerance_m: float = 0.35
    """corresponding edges differ by no more"""
    candidates: int = 6
    """correspondences of a triangle, the most similar first"""
    least_edge_m: float = 0.5
    """triangles with a shorter edge determine no heading"""
    neighbours: int = 5
    """nearest landmarks that also span triangles with each landmark: they survive where a missing
    landmark changes the triangulation; 0 leaves the Delaunay triangles alone"""
    longest_edge_m: float = 80.0
    """longer triangles, along the hull, are seldom in another map"""


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """Triangles of one landmark map, their corners in the order of the opposite edges' lengths."""

    corners: NDArray[np.int64]
    """(t, 3): landmarks; the shortest edge lies opposite the first"""
    edges_m: NDArray[np.float64]
    """(t, 3): ascending edge lengths"""
    centres_m: Points
    """(t, 2)"""
    left_handed: NDArray[np.bool_]
    """(t,): whether the corners run clockwise; a motion of the plane keeps it"""
    features: NDArray[np.float64]
    """(t, 2): perimeter (eq. 4.14) and square root of the area (eq. 4.15) [m]"""
    tree: KDTree | None
    """over the features; None without triangles"""


def triangulate(positions_m: Points, parameters: TriangleParameters | None = None) -> Triangles:
    """Triangles of a landmark map with features, O(n log n).

    The square root makes the area's error as large as the perimeter's, so that one scale fits both.
    """
    parameters = parameters or TriangleParameters()
    chosen = _delaunay(positions_m)
    if parameters.neighbours >= 2 and len(positions_m) > 3:
        chosen = np.concatenate([chosen, _among_neighbours(positions_m, parameters.neighbours)])
        chosen = np.unique(np.sort(chosen, axis=1), axis=0)
    at = positions_m[chosen]
    # Edge k lies opposite corner k.
    lengths = np.linalg.norm(np.roll(at, -1, axis=1) - np.roll(at, -2, axis=1), axis=2)
    keep = (lengths.min(axis=1, initial=np.inf) >= parameters.least_edge_m) & (
        lengths.max(axis=1, initial=0.0) <= parameters.longest_edge_m
    )
    chosen, lengths = chosen[keep], lengths[keep]
    order = np.argsort(lengths, axis=1, kind="stable")
    corners = np.take_along_axis(chosen, order, axis=1)
    edges = np.take_along_axis(lengths, order, axis=1)
    at = positions_m[corners]
    side, other = at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]
    signed = 0.5 * (side[:, 0] * other[:, 1] - side[:, 1] * other[:, 0])
    perimeter = edges.sum(axis=1)
    # Heron's formula (4.15) is this area; the cross product does not cancel for flat triangles.
    features = np.stack([perimeter, np.sqrt(np.abs(signed))], axis=1)
    tree = KDTree(features) if len(features) else None
    return Triangles(corners, edges, at.mean(axis=1), signed < 0.0, features, tree)


def _delaunay(positions_m: Points) -> NDArray[np.int64]:
    if len(positions_m) < 3:
        return np.zeros((0, 3), dtype=np.int64)
    try:
        return np.asarray(Delaunay(positions_m).simplices, dtype=np.int64)
    except QhullError:
        # All landmarks on a line.
        return np.zeros((0, 3), dtype=np.int64)


def _among_neighbours(positions_m: Points, count: int) -> NDArray[np.int64]:
    """(m, 3): every landmark with every two of its nearest."""
    count = min(count, len(positions_m) - 1)
    _, nearest = KDTree(positions_m).query(positions_m, count + 1)
    first, second = np.triu_indices(count, 1)
    own = np.repeat(np.arange(len(positions_m)), len(first))
    around = np.asarray(nearest, dtype=np.int64)[:, 1:]
    return np.stack([own, around[:, first].ravel(), around[:, second].ravel()], axis=1)


def dissimilarity(
    features_a: NDArray[np.float64], features_b: NDArray[np.float64], scale_m: float
) -> NDArray[np.float64]:
    """(...,): S of eq. 4.17, 1 for congruent triangles, growing with their difference."""
    apart = (features_a - features_b) / scale_m
    return np.asarray(np.exp(np.minimum(np.sum(apart**2, axis=-1), 700.0)))


def correspondences(
    a: Triangles, b: Triangles, parameters: TriangleParameters | None = None
) -> NDArray[np.int64]:
    """(m, 2): triangles of `a` and of `b` with S < tau (eq. 4.16), found by tree search.

    Of each triangle's partners, the most similar ones; then those whose edges do not fit one by
    one, or that are mirror images, are dropped: both follow from congruence, and cost nothing.
    """
    parameters = parameters or TriangleParameters()
    if a.tree is None or b.tree is None:
        return np.zeros((0, 2), dtype=np.int64)
    radius = parameters.scale_m * np.sqrt(np.log(parameters.tau))
    count = min(parameters.candidates, len(b.features))
    _, found = b.tree.query(a.features, count, distance_upper_bound=radius)
    partner = np.asarray(found, dtype=np.int64).reshape(len(a.features), -1)
    row, column = np.nonzero(partner < len(b.features))
    pairs = np.stack([row, partner[row, column]], axis=1)
    fits = np.all(
        np.abs(a.edges_m[pairs[:, 0]] - b.edges_m[pairs[:, 1]]) < parameters.edge_tolerance_m,
        axis=1,
    )
    fits &= a.left_handed[pairs[:, 0]] == b.left_handed[pairs[:, 1]]
    return np.asarray(pairs[fits])


def motions(
    a: Triangles, b: Triangles, pairs: NDArray[np.int64], from_m: Points, to_m: Points
) -> Poses:
    """(m, 3): for each correspondence the motion that brings `b` onto `a`, by its three corners.

    The thesis uses only the centres, for which it needs two correspondences; the order of the
    edges' lengths tells the corners apart, so that one is enough.

    Args:
        a: triangles of the map that stays.
        b: triangles of the map that is moved.
        pairs: (m, 2) correspondences.
        from_m: landmarks of `b`.
        to_m: landmarks of `a`.
    """
    target = to_m[a.corners[pairs[:, 0]]]
    source = from_m[b.corners[pairs[:, 1]]]
    centre_t, centre_s = target.mean(axis=1), source.mean(axis=1)
    t, s = target - centre_t[:, None], source - centre_s[:, None]
    sine = np.sum(s[..., 0] * t[..., 1] - s[..., 1] * t[..., 0], axis=1)
    cosine = np.sum(s[..., 0] * t[..., 0] + s[..., 1] * t[..., 1], axis=1)
    turn = np.arctan2(sine, cosine)
    c, d = np.cos(turn), np.sin(turn)
    x = centre_t[:, 0] - (c * centre_s[:, 0] - d * centre_s[:, 1])
    y = centre_t[:, 1] - (d * centre_s[:, 0] + c * centre_s[:, 1])
    return np.stack([x, y, wrap(turn)], axis=1)
