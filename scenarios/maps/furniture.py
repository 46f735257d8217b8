"""Furniture: shelves and boxes that hide parts of a room from a laser range finder."""

from __future__ import annotations

from random import Random

from scenarios.maps.floor_plan import FloorPlan, Rectangle

_GANGWAY = 5
"""cells that stay free around each piece, and along the walls"""
_TRIES = 12


def furnish(plan: FloorPlan, room: int, *, cells_a_piece: int, random: Random) -> None:
    """Puts pieces of furniture into a room, one for every so many cells of its floor if they fit.

    Every piece keeps a gangway around it, so that all of the room stays within reach.
    """
    interior = plan.spaces[room].interior
    placed: list[Rectangle] = []
    for _ in range(interior.width * interior.height // cells_a_piece):
        for _ in range(_TRIES):
            piece = _piece(interior, random)
            if piece is not None and not any(_touch(piece.grown(_GANGWAY), p) for p in placed):
                placed.append(piece)
                break
    plan.pillars.extend(placed)


def _piece(interior: Rectangle, random: Random) -> Rectangle | None:
    """A shelf or a box somewhere in a room; None if it does not fit."""
    length, depth = (random.randint(7, 16), 2) if random.random() < 0.6 else (4, 4)
    width, height = (length, depth) if random.random() < 0.5 else (depth, length)
    free_x = interior.width - 2 * _GANGWAY - width
    free_y = interior.height - 2 * _GANGWAY - height
    if free_x < 0 or free_y < 0:
        return None
    x = interior.x0 + _GANGWAY + random.randint(0, free_x)
    y = interior.y0 + _GANGWAY + random.randint(0, free_y)
    return Rectangle(x, y, x + width, y + height)


def _touch(a: Rectangle, b: Rectangle) -> bool:
    return a.x0 < b.x1 and b.x0 < a.x1 and a.y0 < b.y1 and b.y0 < a.y1
