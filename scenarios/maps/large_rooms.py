"""A floor of 54 x 36 m with large, cluttered rooms on both sides of a corridor.

The width of the building in Bremen that the thesis explored and filled with clutter (section 2.6).
"""

from __future__ import annotations

from random import Random

from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.furniture import furnish
from scenarios.maps.rooms import RoomStyle, fill_row

ROOMS = RoomStyle(width=(48, 90), depth=(78, 80), door=7, suite=0.0, connected=0.15)
CORRIDOR = 13


def draw(seed: int) -> FloorPlan:
    """Draws the floor of 270 x 180 cells of 0.2 m."""
    random = Random(f"large rooms {seed}")
    plan = FloorPlan("large_rooms", width=270, height=180, resolution_m=0.2)
    corridor = plan.add("corridor", Rectangle(2, 84, 268, 84 + CORRIDOR))
    rooms = fill_row(plan, corridor, "south", (2, 268), style=ROOMS, random=random)
    rooms += fill_row(plan, corridor, "north", (2, 268), style=ROOMS, random=random)
    for room in rooms:
        furnish(plan, room, cells_a_piece=110, random=random)
    return plan
