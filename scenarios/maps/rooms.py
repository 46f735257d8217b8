"""Fills strips beside corridors with rooms: the part that hospital and office floors share."""

from __future__ import annotations

from dataclasses import dataclass
from random import Random
from typing import Literal

from scenarios.maps.floor_plan import FloorPlan, Rectangle

Side = Literal["south", "north", "west", "east"]


@dataclass(frozen=True)
class RoomStyle:
    """Sizes in cells and probabilities of a row of rooms."""

    width: tuple[int, int] = (20, 42)
    depth: tuple[int, int] = (34, 52)
    door: int = 7
    """width of a door"""
    suite: float = 0.3
    """probability that a deep room is split into an outer and an inner one"""
    connected: float = 0.15
    """probability of a second door, to the neighbouring room"""
    kind: str = "room"


def cut(length: int, parts: tuple[int, int], random: Random) -> list[int]:
    """Cuts `length` cells into pieces of `parts` cells, one cell of wall between two pieces."""
    shortest, longest = parts
    pieces: list[int] = []
    while length > longest:
        piece = random.randint(shortest, longest)
        if length - piece - 1 < shortest:
            piece = (length - 1) // 2
        pieces.append(piece)
        length -= piece + 1
    return [*pieces, length] if length > 0 else pieces


def fill_row(
    plan: FloorPlan,
    corridor: int,
    side: Side,
    span: tuple[int, int],
    *,
    style: RoomStyle,
    random: Random,
) -> list[int]:
    """Lines rooms up along `side` of a corridor and returns their indices.

    They lie between the columns (or rows) `span`. Every room gets a door to the corridor. A deep
    room may be split into an outer and an inner room, and neighbours may be connected.
    """
    depth = random.randint(*style.depth)
    outer: list[int] = []
    added: list[int] = []
    position = span[0]
    for width in cut(span[1] - span[0], style.width, random):
        along = (position, position + width)
        position += width + 1
        if depth >= 40 and random.random() < style.suite:
            front = random.randint(depth // 2 - 4, depth // 2 + 4)
            first = plan.add(style.kind, _beside(plan, corridor, side, along, near=0, far=front))
            second = plan.add(
                style.kind, _beside(plan, corridor, side, along, near=front + 1, far=depth)
            )
            open_between(plan, first, second, style.door, random)
            added += [first, second]
        else:
            first = plan.add(style.kind, _beside(plan, corridor, side, along, near=0, far=depth))
            added.append(first)
        open_between(plan, corridor, first, style.door, random)
        if outer and random.random() < style.connected:
            open_between(plan, outer[-1], first, style.door, random)
        outer.append(first)
    return added


def _beside(
    plan: FloorPlan, corridor: int, side: Side, along: tuple[int, int], *, near: int, far: int
) -> Rectangle:
    """The rectangle that lies `near` to `far` cells behind the corridor's wall on `side`."""
    hall = plan.spaces[corridor].interior
    if side == "south":
        return Rectangle(along[0], hall.y0 - 1 - far, along[1], hall.y0 - 1 - near)
    if side == "north":
        return Rectangle(along[0], hall.y1 + 1 + near, along[1], hall.y1 + 1 + far)
    if side == "west":
        return Rectangle(hall.x0 - 1 - far, along[0], hall.x0 - 1 - near, along[1])
    return Rectangle(hall.x1 + 1 + near, along[0], hall.x1 + 1 + far, along[1])


def open_between(
    plan: FloorPlan, first: int, second: int, width: int | None, random: Random | None
) -> None:
    """Cuts a door of `width` cells into the wall that two spaces share; all of it if None."""
    a, b = plan.spaces[first].interior, plan.spaces[second].interior
    low_x, high_x = max(a.x0, b.x0), min(a.x1, b.x1)
    low_y, high_y = max(a.y0, b.y0), min(a.y1, b.y1)
    if high_x > low_x and (a.y1 + 1 == b.y0 or b.y1 + 1 == a.y0):
        wall = min(a.y1, b.y1)
        start, end = _run(low_x, high_x, width, random)
        box = Rectangle(start, wall, end, wall + 1)
    elif high_y > low_y and (a.x1 + 1 == b.x0 or b.x1 + 1 == a.x0):
        wall = min(a.x1, b.x1)
        start, end = _run(low_y, high_y, width, random)
        box = Rectangle(wall, start, wall + 1, end)
    else:
        raise ValueError(f"spaces {first} ({a}) and {second} ({b}) share no wall")
    plan.open(box, (first, second), door=width is not None)


def _run(low: int, high: int, width: int | None, random: Random | None) -> tuple[int, int]:
    """A run of `width` cells within [low, high), two cells clear of the corners if it can."""
    if width is None or high - low <= width:
        return low, high
    if random is None:
        start = (low + high - width) // 2
    else:
        clear = min(2, (high - low - width) // 2)
        start = random.randint(low + clear, high - width - clear)
    return start, start + width
