"""An office floor of 37 x 14 m: two corridors in line, a door between them, and small rooms.

The size and the plan of building 079 in Freiburg, where the thesis explored (section 2.6).
"""

from __future__ import annotations

from random import Random

from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.furniture import furnish
from scenarios.maps.rooms import RoomStyle, fill_row, open_between

ROOMS = RoomStyle(width=(14, 27), depth=(26, 27), door=5, suite=0.0, connected=0.1)
CORRIDOR = 11


def draw(seed: int) -> FloorPlan:
    """Draws the floor of 187 x 72 cells of 0.2 m."""
    random = Random(f"small rooms {seed}")
    plan = FloorPlan("small_rooms", width=187, height=72, resolution_m=0.2)
    middle = 90 + random.randint(-12, 12)
    west = plan.add("corridor", Rectangle(2, 30, middle, 30 + CORRIDOR))
    east = plan.add("corridor", Rectangle(middle + 1, 30, 185, 30 + CORRIDOR))
    open_between(plan, west, east, 6, None)
    for corridor, span in ((west, (2, middle)), (east, (middle + 1, 185))):
        rooms = fill_row(plan, corridor, "south", span, style=ROOMS, random=random)
        rooms += fill_row(plan, corridor, "north", span, style=ROOMS, random=random)
        for room in rooms:
            furnish(plan, room, cells_a_piece=260, random=random)
    return plan
