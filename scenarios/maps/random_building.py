"""Random buildings: one to three long corridors, passages between them, rooms of all sizes.

Experiments that vary the map, not only the start, draw a new one for each seed.
"""

from __future__ import annotations

from itertools import pairwise
from random import Random

from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.rooms import RoomStyle, fill_row, open_between

WIDTH, HEIGHT = (320, 560), (150, 280)
"""extent in cells of 0.2 m: 64 to 112 m by 30 to 56 m"""


def draw(seed: int) -> FloorPlan:
    """Draws a building whose size, corridors and rooms all depend on the seed."""
    random = Random(f"random building {seed}")
    plan = FloorPlan(
        "random_building", random.randint(*WIDTH), random.randint(*HEIGHT), resolution_m=0.2
    )
    hall = random.randint(11, 17)
    halls = 1 if plan.height < 190 else 2 + (plan.height > 260)
    pitch = plan.height // halls
    depth_limit = (pitch - hall - 6) // 2
    corridors = [
        plan.add(
            "corridor",
            Rectangle(
                4,
                k * pitch + pitch // 2 - hall // 2,
                plan.width - 4,
                k * pitch + pitch // 2 - hall // 2 + hall,
            ),
        )
        for k in range(halls)
    ]
    crossings: list[list[int]] = []
    for lower, upper in pairwise(corridors):
        crossings.append(_passages(plan, lower, upper, hall, random))
    for k, corridor in enumerate(corridors):
        below = crossings[k - 1] if k > 0 else []
        above = crossings[k] if k < len(crossings) else []
        for side, cuts in (("south", below), ("north", above)):
            for span in _between(cuts, hall, plan.width):
                style = _style(depth_limit, random)
                if side == "south":
                    fill_row(plan, corridor, "south", span, style=style, random=random)
                else:
                    fill_row(plan, corridor, "north", span, style=style, random=random)
    return plan


def _passages(plan: FloorPlan, lower: int, upper: int, hall: int, random: Random) -> list[int]:
    """Two or three corridors from one long corridor to the next; returns their columns."""
    bottom, top = plan.spaces[lower].interior.y1 + 1, plan.spaces[upper].interior.y0 - 1
    parts = random.randint(2, 3)
    columns = []
    for k in range(parts):
        share = plan.width // parts
        x = k * share + random.randint(share // 4, share - share // 4 - hall)
        passage = plan.add("corridor", Rectangle(x, bottom, x + hall, top))
        open_between(plan, lower, passage, None, None)
        open_between(plan, passage, upper, None, None)
        columns.append(x)
    return columns


def _between(columns: list[int], hall: int, width: int) -> list[tuple[int, int]]:
    """The spans that passages at these columns leave for rooms; slivers stay empty."""
    edges = [3, *[edge for x in columns for edge in (x - 1, x + hall)], width - 4]
    spans = [(a + 1, b) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    return [(a, b) for a, b in spans if b - a >= 16]


def _style(depth_limit: int, random: Random) -> RoomStyle:
    narrow = random.randint(16, 30)
    depth = random.randint(min(24, depth_limit), min(60, depth_limit))
    return RoomStyle(
        width=(narrow, round(narrow * random.uniform(1.6, 2.6))),
        depth=(depth, depth),
        door=random.randint(6, 8),
        suite=random.uniform(0.1, 0.6),
        connected=random.uniform(0.0, 0.3),
    )
