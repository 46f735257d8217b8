"""A hospital floor of 120 x 60 m: two long corridors, three passages, a north wing, ninety rooms.

The thesis drew its hospital map from the Fort Sam Houston hospital (section 3.6.5): long corridors
and many rooms.
"""

from __future__ import annotations

from random import Random

from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.rooms import RoomStyle, fill_row, open_between

ROOMS = RoomStyle()
WARDS = RoomStyle(width=(56, 84), depth=(44, 56), suite=0.0)
WING = RoomStyle(width=(18, 28), depth=(36, 44), suite=0.25, connected=0.0)
CORRIDOR = 15
"""width of a corridor, in cells of 0.2 m"""


def draw(seed: int) -> FloorPlan:
    """Draws the floor of 600 x 300 cells of 0.2 m."""
    random = Random(seed)
    plan = FloorPlan("hospital", width=600, height=300, resolution_m=0.2)
    south = plan.add("corridor", Rectangle(10, 70, 590, 70 + CORRIDOR))
    north = plan.add("corridor", Rectangle(10, 215, 590, 215 + CORRIDOR))
    passages = [
        100 + random.randint(-14, 14),
        286 + random.randint(-8, 8),
        474 + random.randint(-14, 14),
    ]
    for x in passages:
        passage = plan.add("corridor", Rectangle(x, 86, x + CORRIDOR, 214))
        open_between(plan, south, passage, None, None)
        open_between(plan, passage, north, None, None)
    wing = plan.add("corridor", Rectangle(passages[1], 231, passages[1] + CORRIDOR, 294))
    open_between(plan, north, wing, None, None)

    for span in ((10, 148), (149, 290), (291, 452), (453, 590)):
        fill_row(
            plan,
            south,
            "south",
            span,
            style=WARDS if random.random() < 0.25 else ROOMS,
            random=random,
        )
    edges = [9, *[edge for x in passages for edge in (x - 1, x + CORRIDOR)], 590]
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        fill_row(plan, south, "north", (start + 1, end), style=ROOMS, random=random)
        fill_row(plan, north, "south", (start + 1, end), style=ROOMS, random=random)
    wing_rooms = [
        fill_row(plan, wing, side, (231, 294), style=WING, random=random)
        for side in ("west", "east")
    ]
    west = min(plan.spaces[room].interior.x0 for room in wing_rooms[0])
    east = max(plan.spaces[room].interior.x1 for room in wing_rooms[1])
    for span in ((10, 120), (121, west - 1), (east + 1, 470), (471, 590)):
        fill_row(
            plan,
            north,
            "north",
            span,
            style=WARDS if random.random() < 0.25 else ROOMS,
            random=random,
        )
    return plan
