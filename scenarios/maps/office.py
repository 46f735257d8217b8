"""An office floor of 85 x 43 m for marsupial teams: two corridors, rooms that only rovers enter.

The thesis's office (section 3.6.2) is 23.8 rover ranges large: 95 m at 4 m. Terrain: `open` for
carriers, `cluttered` for rovers, `threshold` in front of cluttered rooms for both.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from random import Random

from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.rooms import RoomStyle, fill_row, open_between
from scenarios.maps.terrain import clutter

ROOMS = RoomStyle(width=(26, 44), depth=(34, 40), door=8, suite=0.0, connected=0.1)
CORRIDOR = 15
CLUTTERED_SHARE = 0.6
"""share of the rooms that only rovers enter"""


def draw(seed: int) -> FloorPlan:
    """Draws the floor of 425 x 214 cells of 0.2 m."""
    random = Random(seed)
    plan = FloorPlan("office", width=425, height=214, resolution_m=0.2)
    south = plan.add("corridor", Rectangle(6, 46, 419, 46 + CORRIDOR))
    north = plan.add("corridor", Rectangle(6, 151, 419, 151 + CORRIDOR))
    columns = [6, 200 + random.randint(-30, 30), 404]
    for x in columns:
        passage = plan.add("corridor", Rectangle(x, 62, x + CORRIDOR, 150))
        open_between(plan, south, passage, None, None)
        open_between(plan, passage, north, None, None)
    rooms = fill_row(plan, south, "south", (6, 419), style=ROOMS, random=random)
    rooms += fill_row(plan, north, "north", (6, 419), style=ROOMS, random=random)
    for a, b in pairwise(columns):
        span = (a + CORRIDOR + 1, b - 1)
        style = replace(ROOMS, connected=0.0)
        rooms += fill_row(plan, south, "north", span, style=style, random=random)
        rooms += fill_row(plan, north, "south", span, style=style, random=random)
    chosen = random.sample(rooms, round(CLUTTERED_SHARE * len(rooms)))
    return clutter(plan, sorted(chosen))
