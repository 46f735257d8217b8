"""Places mission targets in rooms and blockades across doors and corridors of a floor plan.

Where only few targets lie behind a blockade, clearing hardly matters and no comparison of
strategies can show anything: the placement seals a wanted share of the targets and reports the
share it reached.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot
from random import Random

import numpy as np
from numpy.typing import NDArray

from scenarios.maps.floor_plan import FREE, OCCUPIED, FloorPlan, Point, Segment
from scenarios.maps.free_space import closed, component_at, components


@dataclass(frozen=True)
class PlacementParameters:
    """How many, and how much of the mission hangs on clearing."""

    targets: int = 15
    blockades: int = 18
    sealed_share: float = 0.4
    """share of the targets that cannot be reached before something is cleared"""
    sealed_share_limit: float = 0.5
    corridor_share: float = 0.3
    """share of the blockades that stand across corridors"""
    clear_s_per_m: float = 12.0
    """clearing time grows with the size of a blockade (section 3.6.5)"""
    clearance_m: float = 0.3
    target_rooms: tuple[str, ...] = ("room",)


@dataclass(frozen=True)
class Target:
    """A place to visit, in the map frame."""

    id: str
    position_m: Point


@dataclass(frozen=True)
class Blockade:
    """A segment in the map frame that blocks the way until it has been cleared."""

    id: str
    segment_m: Segment
    clear_duration_s: float

    @property
    def length_m(self) -> float:
        (x0, y0), (x1, y1) = self.segment_m
        return hypot(x1 - x0, y1 - y0)


@dataclass(frozen=True)
class Placement:
    """Targets and blockades of a floor, and the share of the targets that the blockades seal."""

    targets: tuple[Target, ...]
    blockades: tuple[Blockade, ...]
    sealed_fraction: float


def place(plan: FloorPlan, seed: int, parameters: PlacementParameters | None = None) -> Placement:
    """Places targets and blockades; ValueError where the floor has too few rooms or openings."""
    parameters = parameters or PlacementParameters()
    random = Random(f"{plan.name} {seed}")
    rooms = _target_rooms(plan, parameters, random)
    positions = [_inside(plan, room, random) for room in rooms]
    segments = _segments(plan, rooms, positions, parameters, random)
    targets = tuple(Target(f"target_{k}", p) for k, p in enumerate(positions, start=1))
    blockades = tuple(
        Blockade(f"blockade_{k}", segment, _clear_duration_s(segment, parameters))
        for k, segment in enumerate(sorted(segments), start=1)
    )
    cells = plan.cells()
    sealed = sealed_fraction(cells, plan.resolution_m, positions, segments, parameters.clearance_m)
    return Placement(targets, blockades, round(sealed, 3))


def sealed_fraction(
    cells: NDArray[np.int8],
    resolution_m: float,
    positions_m: Sequence[Point],
    segments_m: Sequence[Segment],
    clearance_m: float,
) -> float:
    """Share of the positions outside the largest component while every blockade is closed."""
    labels = components(closed(cells, resolution_m, segments_m), resolution_m, clearance_m)
    outside = sum(component_at(labels, resolution_m, p) != 1 for p in positions_m)
    return outside / max(1, len(positions_m))


def _target_rooms(plan: FloorPlan, parameters: PlacementParameters, random: Random) -> list[int]:
    """Rooms far from one another: the best of eight random candidates each time."""
    left = [k for k, space in enumerate(plan.spaces) if space.kind in parameters.target_rooms]
    if len(left) < parameters.targets:
        raise ValueError(f"{plan.name} has {len(left)} rooms for {parameters.targets} targets")
    chosen: list[int] = []
    while len(chosen) < parameters.targets:
        candidates = [random.choice(left) for _ in range(8)]
        best = max(candidates, key=lambda room: _spacing(plan, room, chosen))
        chosen.append(best)
        left.remove(best)
    return chosen


def _spacing(plan: FloorPlan, room: int, chosen: list[int]) -> float:
    x, y = _centre(plan, room)
    return min((hypot(x - a, y - b) for a, b in (_centre(plan, k) for k in chosen)), default=0.0)


def _centre(plan: FloorPlan, room: int) -> Point:
    box = plan.spaces[room].interior
    return (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2


def _inside(plan: FloorPlan, room: int, random: Random) -> Point:
    """A position [m] in a room, a metre from its walls, mid-cell and not on a pillar."""
    box = plan.spaces[room].interior
    cells = plan.cells()
    margin = min(round(1.0 / plan.resolution_m), (min(box.width, box.height) - 1) // 2)
    for _ in range(1000):
        column = random.randint(box.x0 + margin, box.x1 - margin - 1)
        row = random.randint(box.y0 + margin, box.y1 - margin - 1)
        around = cells[
            row - margin // 2 : row + margin // 2 + 1,
            column - margin // 2 : column + margin // 2 + 1,
        ]
        if (around == FREE).all():
            return plan.metres(column + 0.5, row + 0.5)
    raise ValueError(f"space {room} of {plan.name} has no free place for a target")


def _segments(
    plan: FloorPlan,
    rooms: list[int],
    positions: list[Point],
    parameters: PlacementParameters,
    random: Random,
) -> list[Segment]:
    """Closes all openings of the rooms to seal, then adds corridor and door blockades."""
    cells = plan.cells()
    chosen: list[Segment] = []

    def share(segments: list[Segment]) -> float:
        return sealed_fraction(
            cells, plan.resolution_m, positions, segments, parameters.clearance_m
        )

    order = sorted(rooms, key=lambda room: (len(_openings_of(plan, room)), random.random()))
    for room in order:
        if share(chosen) >= parameters.sealed_share:
            break
        doors = [plan.across(plan.openings[k]) for k in _openings_of(plan, room)]
        fresh = [segment for segment in doors if segment not in chosen]
        if len(chosen) + len(fresh) <= parameters.blockades:
            chosen += fresh
    corridors = round(parameters.corridor_share * parameters.blockades)
    across = corridor_sections(plan, random)
    doors = [plan.across(opening) for opening in plan.openings if opening.door]
    random.shuffle(doors)
    for candidates, limit in (
        (across, len(chosen) + corridors),
        (doors + across, parameters.blockades),
    ):
        for segment in candidates:
            if len(chosen) >= min(limit, parameters.blockades):
                break
            far = all(_gap(segment, other) > 3.0 for other in chosen)
            if far and share([*chosen, segment]) <= parameters.sealed_share_limit:
                chosen.append(segment)
    if len(chosen) < parameters.blockades:
        raise ValueError(
            f"{plan.name} has room for {len(chosen)} of {parameters.blockades} blockades"
        )
    return chosen


def _openings_of(plan: FloorPlan, room: int) -> list[int]:
    return [k for k, opening in enumerate(plan.openings) if room in opening.joins]


def corridor_sections(plan: FloorPlan, random: Random, every_m: float = 4.0) -> list[Segment]:
    """Cross sections [m] of the corridors from wall to wall, away from doors, in random order."""
    cells = plan.cells()
    sections: list[Segment] = []
    step = max(1, round(every_m / plan.resolution_m))
    for space in plan.spaces:
        if space.kind != "corridor":
            continue
        box = space.interior
        if box.width >= box.height:
            for x in range(box.x0 + step, box.x1 - step, step):
                walls = cells[[box.y0 - 1, box.y1], x - 2 : x + 3]
                if (walls == OCCUPIED).all():
                    sections.append((plan.metres(x + 0.5, box.y0), plan.metres(x + 0.5, box.y1)))
        else:
            for y in range(box.y0 + step, box.y1 - step, step):
                walls = cells[y - 2 : y + 3, [box.x0 - 1, box.x1]]
                if (walls == OCCUPIED).all():
                    sections.append((plan.metres(box.x0, y + 0.5), plan.metres(box.x1, y + 0.5)))
    random.shuffle(sections)
    return sections


def _gap(first: Segment, second: Segment) -> float:
    (ax, ay), (bx, by) = _middle(first), _middle(second)
    return hypot(ax - bx, ay - by)


def _middle(segment: Segment) -> Point:
    (x0, y0), (x1, y1) = segment
    return (x0 + x1) / 2, (y0 + y1) / 2


def _clear_duration_s(segment: Segment, parameters: PlacementParameters) -> float:
    (x0, y0), (x1, y1) = segment
    return round(parameters.clear_s_per_m * hypot(x1 - x0, y1 - y0), 1)
