"""Alignment of two landmark maps by their triangles (thesis 4.4.1, Algorithm 4).

Triangle correspondences vote for motions; consensus (RANSAC or the largest consistent clique) picks
one; the landmarks that it brings together refine it. An alignment counts only if its matches cannot
be chance: the expected number of motions among all that were tried that bring so many landmarks of
unrelated maps together has to be tiny (an a-contrario test: Moisan and Stival, "A Probabilistic
Criterion to Detect Rigid Point Matches", IJCV 2004).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, KDTree, QhullError
from scipy.stats import binom

from simulator.slam.consensus import ConsensusMethod, largest_clique
from simulator.slam.pose import Points, Poses, fit_motion, transform, wrap
from simulator.slam.triangles import (
    TriangleParameters,
    Triangles,
    correspondences,
    dissimilarity,
    motions,
    triangulate,
)


@dataclass(frozen=True, slots=True)
class AlignmentParameters:
    """How two landmark maps are aligned, and when the result counts."""

    triangles: TriangleParameters = field(default_factory=TriangleParameters)
    method: ConsensusMethod = "ransac"
    samples: int = 100
    """motions that RANSAC tries"""
    supporters: int = 500
    """correspondences that judge a motion, drawn if there are more"""
    reach_m: float = 1.0
    """triangle centres that a motion brings so near support it"""
    match_m: float = 0.5
    """landmarks that the final motion brings so near are the same"""
    least_matches: int = 5
    chance: float = 1e-8
    """largest expected number of equally good motions between unrelated maps"""
    verified: int = 3
    """best supported motions whose landmarks are counted"""
    clique: int = 400
    """correspondences among which the largest clique is sought"""


@dataclass(frozen=True, slots=True, eq=False)
class AlignmentFound:
    """A motion between two landmark maps."""

    motion: Poses
    """(3,): brings the second map onto the first"""
    matches: NDArray[np.int64]
    """(k, 2): landmarks of the first and of the second map that are the same"""
    chance: float
    """expected number of equally good motions between unrelated maps"""
    accepted: bool
    correspondences: int
    """triangle pairs that were considered"""


def align_landmarks(
    first_m: Points,
    second_m: Points,
    random: np.random.Generator,
    parameters: AlignmentParameters | None = None,
    triangles: tuple[Triangles, Triangles] | None = None,
) -> AlignmentFound | None:
    """Finds the motion that brings the second landmark map (n, 2) onto the first; O(n log n).

    Args:
        first_m: the map that stays.
        second_m: the map that is moved.
        random: draws RANSAC's samples.
        parameters: see there.
        triangles: of both maps, if they are known already.

    Returns:
        None if not even two correspondences agree.
    """
    parameters = parameters or AlignmentParameters()
    a, b = triangles or (
        triangulate(first_m, parameters.triangles),
        triangulate(second_m, parameters.triangles),
    )
    pairs = correspondences(a, b, parameters.triangles)
    if len(pairs) < 2:
        return None
    hypotheses = motions(a, b, pairs, second_m, first_m)
    centres_a, centres_b = a.centres_m[pairs[:, 0]], b.centres_m[pairs[:, 1]]
    if parameters.method == "pcm":
        order = np.argsort(
            dissimilarity(a.features[pairs[:, 0]], b.features[pairs[:, 1]], 1.0), kind="stable"
        )[: 3 * parameters.supporters]
        candidates = _by_clique(hypotheses[order], centres_a[order], centres_b[order], parameters)
    else:
        candidates = _by_ransac(hypotheses, centres_a, centres_b, random, parameters)
    tree = KDTree(first_m)
    best: tuple[int, Poses, NDArray[np.int64]] | None = None
    for motion in candidates:
        refined, matches = _refine(first_m, second_m, tree, motion, parameters.match_m)
        if best is None or len(matches) > best[0]:
            best = (len(matches), refined, matches)
    if best is None:
        return None
    count, motion, matches = best
    chance = _least_chance(
        first_m, second_m, motion, matches=matches, parameters=parameters, tried=len(pairs)
    )
    accepted = count >= parameters.least_matches and chance < parameters.chance
    return AlignmentFound(motion, matches, chance, accepted, len(pairs))


def _by_ransac(
    hypotheses: Poses,
    centres_a: Points,
    centres_b: Points,
    random: np.random.Generator,
    parameters: AlignmentParameters,
) -> list[Poses]:
    """Motions supported by most correspondences, best first, each unlike the others."""
    tried = _drawn(len(hypotheses), parameters.samples, random)
    judges = _drawn(len(hypotheses), parameters.supporters, random)
    moved = transform(hypotheses[tried], centres_b[judges])
    apart = moved - centres_a[judges]
    supports = np.einsum("hmd,hmd->hm", apart, apart) < parameters.reach_m**2
    votes = supports.sum(axis=1)
    best: list[Poses] = []
    while len(best) < parameters.verified:
        place = int(np.argmax(votes))
        if votes[place] < 2:
            break
        supporters = judges[supports[place]]
        best.append(fit_motion(centres_b[supporters], centres_a[supporters]))
        # The next motion has to be supported by others.
        supports[:, supports[place]] = False
        votes = supports.sum(axis=1)
    return best


def _drawn(count: int, most: int, random: np.random.Generator) -> NDArray[np.intp]:
    if count <= most:
        return np.arange(count)
    return np.sort(random.choice(count, most, replace=False))


def _by_clique(
    hypotheses: Poses, centres_a: Points, centres_b: Points, parameters: AlignmentParameters
) -> list[Poses]:
    """The motion of the largest set of correspondences that agree pair by pair.

    Two agree if their centres are equally far apart in both maps, and if the line between the
    centres is turned as each of the two triangles is.
    """
    x_a = centres_a[:, None] - centres_a[None]
    x_b = centres_b[:, None] - centres_b[None]
    long_a, long_b = np.hypot(x_a[..., 0], x_a[..., 1]), np.hypot(x_b[..., 0], x_b[..., 1])
    turned = np.arctan2(x_a[..., 1], x_a[..., 0]) - np.arctan2(x_b[..., 1], x_b[..., 0])
    heading = hypotheses[:, 2]
    near = long_b < 2.0
    straight = np.abs(wrap(turned - heading[:, None])) < 0.15
    together = np.abs(wrap(heading[:, None] - heading[None])) < 0.15
    agrees = (np.abs(long_a - long_b) < parameters.reach_m) & together & (near | straight)
    clique = largest_clique(agrees, parameters.clique)
    if len(clique) < 2:
        return []
    return [fit_motion(centres_b[clique], centres_a[clique])]


def _refine(
    first_m: Points, second_m: Points, tree: KDTree, motion: Poses, match_m: float
) -> tuple[Poses, NDArray[np.int64]]:
    """The motion that fits the landmarks it brings together, the reach narrowing."""
    matches = np.zeros((0, 2), dtype=np.int64)
    for reach_m in (3.0 * match_m, 1.5 * match_m, match_m, match_m):
        matches = matched_landmarks(second_m, tree, motion, reach_m)
        if len(matches) < 3:
            return motion, matches
        motion = fit_motion(second_m[matches[:, 1]], first_m[matches[:, 0]])
    return motion, matched_landmarks(second_m, tree, motion, match_m)


def matched_landmarks(
    second_m: Points, tree: KDTree, motion: Poses, reach_m: float
) -> NDArray[np.int64]:
    """(k, 2): landmarks that are each other's nearest after the motion, within reach."""
    found = tree.query(transform(motion, second_m), distance_upper_bound=reach_m)
    apart, nearest = np.asarray(found[0]), np.asarray(found[1])
    own = np.flatnonzero(np.isfinite(apart))
    order = own[np.lexsort((apart[own], nearest[own]))]
    _, first = np.unique(nearest[order], return_index=True)
    chosen = np.sort(order[first])
    return np.stack([nearest[chosen], chosen], axis=1).astype(np.int64)


_SHARPNESS = (1.0, 0.5, 0.25)
"""shares of the matching distance at which matches are counted"""


def _least_chance(
    first_m: Points,
    second_m: Points,
    motion: Poses,
    *,
    matches: NDArray[np.int64],
    parameters: AlignmentParameters,
    tried: int,
) -> float:
    """The chance at the sharpest distance that the matches keep, for all distances looked at.

    Right matches lie nearer than they would have to; matches by chance fill the whole disc.
    """
    apart = np.linalg.norm(
        transform(motion, second_m[matches[:, 1]]) - first_m[matches[:, 0]], axis=1
    )
    reaches = [parameters.match_m * share for share in _SHARPNESS]
    return min(
        chance_of_alignment(
            first_m,
            second_m,
            motion,
            count=int(np.count_nonzero(apart <= reach_m)),
            match_m=reach_m,
            tried=tried * len(reaches),
        )
        for reach_m in reaches
    )


def chance_of_alignment(
    first_m: Points,
    second_m: Points,
    motion: Poses,
    *,
    count: int,
    match_m: float,
    tried: int,
) -> float:
    """Expected number of motions, of those tried, that match so many landmarks by chance.

    A landmark that falls into the first map's hull meets one of its landmarks with the probability
    that their discs cover; the two matches that fix the motion count for nothing.
    """
    try:
        hull = ConvexHull(first_m)
    except (QhullError, ValueError):
        return float(tried)
    sides = transform(motion, second_m) @ hull.equations[:, :2].T + hull.equations[:, 2]
    inside = np.all(sides <= match_m, axis=1)
    area = max(float(hull.volume), len(first_m) * np.pi * match_m**2)
    probability = min(1.0, len(first_m) * np.pi * match_m**2 / area)
    others = max(int(np.count_nonzero(inside)), count) - 2
    if count <= 2 or others <= 0:
        return float(tried)
    return float(tried * binom.sf(count - 3, others, probability))
