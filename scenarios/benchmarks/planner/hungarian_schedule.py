"""A whole mission scheduled by the Hungarian method, one assignment whenever a robot is free.

The rule of thesis 3.6.6 with everything known and nothing in the way: free explorers to targets
that can be reached now, free clearers to blockades that seal targets, each time at the least sum of
durations. Those that get nothing wait for the next event.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Mission:
    """Positions (n, 2) [m]; every way is straight."""

    explorers_m: Array
    clearers_m: Array
    targets_m: Array
    blockades_m: Array
    gates: NDArray[np.int64]
    """for each target the blockade through which alone it is reached, or -1"""
    explorer_m_s: float
    clearer_m_s: float
    clear_s: float


def hungarian_makespan_s(mission: Mission) -> float:
    """When the last target is reached [s]; infinite if that never happens."""
    explorer_at, clearer_at = mission.explorers_m.copy(), mission.clearers_m.copy()
    explorer_free_s = np.zeros(len(explorer_at))
    clearer_free_s = np.zeros(len(clearer_at))
    open_from_s = np.full(len(mission.blockades_m), np.inf)
    needed = np.unique(mission.gates[mission.gates >= 0]).tolist()
    to_clear, to_visit = needed, list(range(len(mission.targets_m)))
    now_s = end_s = 0.0
    while to_visit:
        free = np.flatnonzero(clearer_free_s <= now_s)
        cost = _distances(clearer_at[free], mission.blockades_m[to_clear]) / mission.clearer_m_s
        for robot, goal in _assigned(cost):
            r, b = free[robot], to_clear[goal]
            clearer_free_s[r] = now_s + cost[robot, goal] + mission.clear_s
            open_from_s[b] = clearer_free_s[r]
            clearer_at[r] = mission.blockades_m[b]
        to_clear = [b for b in to_clear if not np.isfinite(open_from_s[b])]

        free = np.flatnonzero(explorer_free_s <= now_s)
        cost = _explorer_costs(mission, explorer_at[free], to_visit, open_from_s <= now_s)
        gone = []
        for robot, goal in _assigned(cost):
            r, t = free[robot], to_visit[goal]
            explorer_free_s[r] = now_s + cost[robot, goal]
            end_s = max(end_s, explorer_free_s[r])
            # From behind its gate a robot goes on from the gate: the way out is the way in.
            explorer_at[r] = mission.targets_m[t]
            if mission.gates[t] >= 0:
                gate = mission.blockades_m[mission.gates[t]]
                explorer_free_s[r] += _length(mission.targets_m[t] - gate) / mission.explorer_m_s
                explorer_at[r] = gate
            gone.append(t)
        to_visit = [t for t in to_visit if t not in gone]
        events = np.concatenate([explorer_free_s, clearer_free_s, open_from_s])
        later = events[np.isfinite(events) & (events > now_s)]
        if to_visit and not len(later):
            return float("inf")
        now_s = float(later.min()) if len(later) else now_s
    return end_s


def _explorer_costs(
    mission: Mission, at: Array, targets: list[int], is_open: NDArray[np.bool_]
) -> Array:
    """Durations (explorers, targets) [s], through the gate where there is one."""
    straight = _distances(at, mission.targets_m[targets])
    for column, target in enumerate(targets):
        gate = mission.gates[target]
        if gate < 0:
            continue
        place = mission.blockades_m[gate]
        around = _distances(at, place[None])[:, 0] + _length(mission.targets_m[target] - place)
        straight[:, column] = around if is_open[gate] else np.inf
    return straight / mission.explorer_m_s


def _assigned(cost: Array) -> list[tuple[int, int]]:
    """Pairs of the assignment that are possible."""
    if cost.size == 0:
        return []
    shut = 1e9
    rows, columns = linear_sum_assignment(np.where(np.isfinite(cost), cost, shut))
    return [(int(r), int(c)) for r, c in zip(rows, columns, strict=True) if np.isfinite(cost[r, c])]


def _distances(one: Array, other: Array) -> Array:
    return np.asarray(np.linalg.norm(one[:, None] - other[None], axis=2))


def _length(vector: Array) -> float:
    return float(np.hypot(*vector))
