"""Finds doors and corridors of a building by width; places targets and blockades among them.

Generated floors know their doors; a drawing or a map made by a robot does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot
from random import Random

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from scenarios.maps.floor_plan import FREE, Point, Segment
from scenarios.maps.free_space import closed, components
from scenarios.maps.placement import (
    Blockade,
    Placement,
    PlacementParameters,
    Target,
    sealed_fraction,
)


@dataclass(frozen=True)
class Passage:
    """A straight line of free cells from wall to wall, and what lies behind it."""

    segment_m: Segment
    width_m: float
    pocket_m2: float
    """free area that closing it cuts off; 0 where there is another way round"""


def find_passages(
    cells: NDArray[np.int8],
    resolution_m: float,
    *,
    clearance_m: float,
    widest_m: float,
    tries: int,
    random: Random,
) -> list[Passage]:
    """Samples free cells and measures the gap between the walls beside them, row- and column-wise.

    Only the narrowest of nearby passages is kept: that is the door, not the room behind it.
    """
    free = cells == FREE
    room = components(cells, resolution_m, clearance_m) == 1
    rows, columns = np.nonzero(room)
    found: list[Passage] = []
    for _ in range(tries):
        k = random.randrange(len(rows))
        gap = _narrower_gap(free, int(rows[k]), int(columns[k]))
        width_m = gap.width * resolution_m
        if width_m <= widest_m and _is_passage(free, gap, resolution_m):
            found.append(Passage(gap.segment_m(resolution_m), round(width_m, 3), 0.0))
    kept: list[Passage] = []
    for passage in sorted(found, key=lambda p: (p.width_m, p.segment_m)):
        if all(_distance(passage.segment_m, other.segment_m) > 2.5 for other in kept):
            kept.append(passage)
    area = int(room.sum())
    return [
        Passage(p.segment_m, p.width_m, _pocket_m2(cells, resolution_m, clearance_m, p, area))
        for p in kept
    ]


def place_in_building(
    cells: NDArray[np.int8],
    resolution_m: float,
    seed: int,
    parameters: PlacementParameters | None = None,
) -> Placement:
    """Targets far from one another; blockades in passages so that enough targets are sealed."""
    parameters = parameters or PlacementParameters()
    random = Random(f"building {seed}")
    passages = find_passages(
        cells,
        resolution_m,
        clearance_m=parameters.clearance_m,
        widest_m=3.4,
        tries=4000,
        random=random,
    )
    positions = _positions(cells, resolution_m, parameters, passages, random)
    segments = _sealing(
        cells, resolution_m, positions, passages, parameters=parameters, random=random
    )
    targets = tuple(Target(f"target_{k}", p) for k, p in enumerate(positions, start=1))
    blockades = tuple(
        Blockade(f"blockade_{k}", s, round(parameters.clear_s_per_m * hypot(*_vector(s)), 1))
        for k, s in enumerate(sorted(segments), start=1)
    )
    share = sealed_fraction(cells, resolution_m, positions, segments, parameters.clearance_m)
    return Placement(targets, blockades, round(share, 3))


def _positions(
    cells: NDArray[np.int8],
    resolution_m: float,
    parameters: PlacementParameters,
    passages: Sequence[Passage],
    random: Random,
) -> list[Point]:
    """The best of twelve candidates each time, a metre from walls and not in a passage."""
    free = cells == FREE
    clearance = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] * resolution_m
    labels = components(cells, resolution_m, parameters.clearance_m)
    rows, columns = np.nonzero((labels == 1) & (clearance >= 0.9))
    doors = [_middle(passage.segment_m) for passage in passages]
    chosen: list[Point] = []
    while len(chosen) < parameters.targets:
        candidates = []
        for _ in range(12):
            k = random.randrange(len(rows))
            x = round((float(columns[k]) + 0.5) * resolution_m, 3)
            y = round((float(rows[k]) + 0.5) * resolution_m, 3)
            if all(hypot(x - a, y - b) > 1.5 for a, b in doors):
                candidates.append((x, y))
        if candidates:
            chosen.append(max(candidates, key=lambda point: _spacing(point, chosen)))
    return chosen


def _sealing(
    cells: NDArray[np.int8],
    resolution_m: float,
    positions: list[Point],
    passages: list[Passage],
    *,
    parameters: PlacementParameters,
    random: Random,
) -> list[Segment]:
    """Adds blockades one by one: while too few targets are sealed, one that seals more."""
    chosen: list[Segment] = []
    share = 0.0

    def with_(segment: Segment) -> float:
        return sealed_fraction(
            cells, resolution_m, positions, [*chosen, segment], parameters.clearance_m
        )

    pockets = [p for p in passages if p.pocket_m2 > 0]
    others = [p for p in passages if p.pocket_m2 == 0]
    random.shuffle(pockets)
    random.shuffle(others)
    for passage in pockets:
        if share >= parameters.sealed_share or len(chosen) == parameters.blockades:
            break
        after = with_(passage.segment_m)
        if share < after <= min(parameters.sealed_share_limit, share + 2.1 / len(positions)):
            chosen.append(passage.segment_m)
            share = after
    for passage in (*others, *pockets):
        if len(chosen) == parameters.blockades:
            break
        if all(_distance(passage.segment_m, other) > 3.0 for other in chosen):
            after = with_(passage.segment_m)
            if after <= parameters.sealed_share_limit:
                chosen.append(passage.segment_m)
    if len(chosen) < parameters.blockades:
        raise ValueError(f"found {len(chosen)} of {parameters.blockades} passages to block")
    return chosen


@dataclass(frozen=True)
class _Gap:
    """The free cells [low, high) between two walls in a row, or in a column if upright."""

    row: int
    column: int
    low: int
    high: int
    upright: bool

    @property
    def width(self) -> int:
        return self.high - self.low

    def segment_m(self, resolution_m: float) -> Segment:
        low, high = round(self.low * resolution_m, 3), round(self.high * resolution_m, 3)
        if self.upright:
            x = round((self.column + 0.5) * resolution_m, 3)
            return (x, low), (x, high)
        y = round((self.row + 0.5) * resolution_m, 3)
        return (low, y), (high, y)


def _narrower_gap(free: NDArray[np.bool_], row: int, column: int) -> _Gap:
    gaps = [
        _Gap(row, column, *_between_walls(free[row], column), upright=False),
        _Gap(row, column, *_between_walls(free[:, column], row), upright=True),
    ]
    return min(gaps, key=lambda gap: gap.width)


def _is_passage(free: NDArray[np.bool_], gap: _Gap, resolution_m: float) -> bool:
    """A door widens on both sides; a corridor keeps its width for three metres on both sides."""

    def width_m(along_m: float) -> float:
        step = round(along_m / resolution_m)
        row, column = (gap.row, gap.column + step) if gap.upright else (gap.row + step, gap.column)
        inside = 0 <= row < free.shape[0] and 0 <= column < free.shape[1]
        if not inside or not free[row, column]:
            return 0.0
        line, at = (free[:, column], row) if gap.upright else (free[row], column)
        low, high = _between_walls(line, at)
        return (high - low) * resolution_m

    here = gap.width * resolution_m
    if here <= 2.0 and min(width_m(-0.8), width_m(0.8)) > here + 0.4:
        return True
    return here >= 1.2 and all(abs(width_m(d) - here) <= 0.6 for d in (-3, -2, -1, 1, 2, 3))


def _between_walls(line: NDArray[np.bool_], at: int) -> tuple[int, int]:
    """The run of free cells around index `at`, half open."""
    walls = np.flatnonzero(~line)
    after = int(np.searchsorted(walls, at))
    low = int(walls[after - 1]) + 1 if after > 0 else 0
    high = int(walls[after]) if after < len(walls) else len(line)
    return low, high


def _pocket_m2(
    cells: NDArray[np.int8],
    resolution_m: float,
    clearance_m: float,
    passage: Passage,
    area: int,
) -> float:
    labels = components(closed(cells, resolution_m, [passage.segment_m]), resolution_m, clearance_m)
    (x0, y0), (x1, y1) = passage.segment_m
    near = labels[
        max(0, int(min(y0, y1) / resolution_m) - 8) : int(max(y0, y1) / resolution_m) + 8,
        max(0, int(min(x0, x1) / resolution_m) - 8) : int(max(x0, x1) / resolution_m) + 8,
    ]
    cut = [int((labels == label).sum()) for label in np.unique(near) if label > 1]
    largest = max(cut, default=0)
    return round(largest * resolution_m**2, 2) if largest < area / 2 else 0.0


def _middle(segment: Segment) -> Point:
    (x0, y0), (x1, y1) = segment
    return (x0 + x1) / 2, (y0 + y1) / 2


def _vector(segment: Segment) -> Point:
    (x0, y0), (x1, y1) = segment
    return x1 - x0, y1 - y0


def _distance(first: Segment, second: Segment) -> float:
    (ax, ay), (bx, by) = _middle(first), _middle(second)
    return hypot(ax - bx, ay - by)


def _spacing(point: Point, chosen: Sequence[Point]) -> float:
    return min((hypot(point[0] - x, point[1] - y) for x, y in chosen), default=0.0)
