"""A power plant of 145 x 78 m: two reactors, a turbine hall, control rooms, a grid of corridors.

The thesis's power plant (section 3.6.5) is 65.9 sensor ranges large: 165 m at a range of 2.5 m. Its
13 targets are grouped around the two reactor cores and the two control rooms.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from random import Random

from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.rooms import RoomStyle, fill_row, open_between

CORRIDOR = 12
REACTOR = RoomStyle(width=(24, 36), depth=(34, 34), suite=0.0, connected=0.3, kind="reactor")
CONTROL = RoomStyle(width=(100, 120), depth=(56, 56), suite=0.0, connected=0.0, kind="control")
STORE = RoomStyle(width=(26, 44), depth=(78, 82), suite=0.8, connected=0.25)
OFFICE = RoomStyle(width=(24, 36), depth=(48, 60), suite=0.4, connected=0.2)
TURBINE_DOOR = 14


def draw(seed: int) -> FloorPlan:
    """Draws the floor of 725 x 390 cells of 0.2 m."""
    random = Random(seed)
    plan = FloorPlan("power_plant", width=725, height=390, resolution_m=0.2)
    south = plan.add("corridor", Rectangle(8, 8, 717, 8 + CORRIDOR))
    middle = plan.add("corridor", Rectangle(8, 189, 717, 189 + CORRIDOR))
    north = plan.add("corridor", Rectangle(8, 370, 717, 370 + CORRIDOR))
    columns = [8, 230 + random.randint(-6, 6), 483 + random.randint(-6, 6), 705]
    uprights = []
    for x in columns:
        lower = plan.add("corridor", Rectangle(x, 21, x + CORRIDOR, 188))
        upper = plan.add("corridor", Rectangle(x, 202, x + CORRIDOR, 369))
        for first, second in ((south, lower), (lower, middle), (middle, upper), (upper, north)):
            open_between(plan, first, second, None, None)
        uprights.append((lower, upper))
    spans = [(a + CORRIDOR + 1, b - 1) for a, b in pairwise(columns)]

    for side in (0, 2):
        around = (south, middle, uprights[side][0], uprights[side + 1][0])
        _reactor(plan, Rectangle(spans[side][0], 21, spans[side][1], 188), around, random)
        fill_row(plan, middle, "north", spans[side], style=STORE, random=random)
        fill_row(plan, north, "south", spans[side], style=STORE, random=random)
    _turbine_hall(plan, Rectangle(spans[1][0], 21, spans[1][1], 188), (south, middle), random)
    fill_row(plan, middle, "north", spans[1], style=CONTROL, random=random)
    fill_row(plan, north, "south", spans[1], style=OFFICE, random=random)
    return plan


def _reactor(
    plan: FloorPlan, block: Rectangle, around: tuple[int, int, int, int], random: Random
) -> None:
    """A ring corridor around the core, rooms around the ring, four ways in from outside."""
    depth = REACTOR.depth[0]
    outer = block.grown(-(depth + 1))
    low = plan.add("corridor", Rectangle(outer.x0, outer.y0, outer.x1, outer.y0 + CORRIDOR))
    high = plan.add("corridor", Rectangle(outer.x0, outer.y1 - CORRIDOR, outer.x1, outer.y1))
    rows = (outer.y0 + CORRIDOR + 1, outer.y1 - CORRIDOR - 1)
    left = plan.add("corridor", Rectangle(outer.x0, rows[0], outer.x0 + CORRIDOR, rows[1]))
    right = plan.add("corridor", Rectangle(outer.x1 - CORRIDOR, rows[0], outer.x1, rows[1]))
    for upright in (left, right):
        open_between(plan, low, upright, None, None)
        open_between(plan, upright, high, None, None)
    below, above, west, east = around
    entry = (outer.x0 + outer.x1) // 2 + random.randint(-20, 20)
    for ring, outside, side, y in (
        (low, below, "south", block.y0),
        (high, above, "north", outer.y1 + 1),
    ):
        way = plan.add("corridor", Rectangle(entry, y, entry + CORRIDOR, y + depth))
        open_between(plan, ring, way, None, None)
        open_between(plan, way, outside, None, None)
        for span in ((outer.x0, entry - 1), (entry + CORRIDOR + 1, outer.x1)):
            fill_row(
                plan,
                ring,
                "south" if side == "south" else "north",
                span,
                style=REACTOR,
                random=random,
            )
    for ring, outside, side in ((left, west, "west"), (right, east, "east")):
        rooms = fill_row(
            plan,
            ring,
            "west" if side == "west" else "east",
            rows,
            style=replace(REACTOR, width=(20, 32)),
            random=random,
        )
        open_between(plan, random.choice(rooms), outside, REACTOR.door, random)


def _turbine_hall(
    plan: FloorPlan, block: Rectangle, corridors: tuple[int, int], random: Random
) -> None:
    """One large hall with two turbines and rows of pillars."""
    hall = plan.add("hall", block)
    for corridor in corridors:
        for _ in range(2):
            open_between(plan, hall, corridor, TURBINE_DOOR, random)
    for x in range(block.x0 + 18, block.x1 - 14, 36):
        for y in range(block.y0 + 18, block.y1 - 14, 32):
            plan.pillars.append(Rectangle(x, y, x + 3, y + 3))
    width = block.width // 2 - 44
    for x in (block.x0 + 26, block.x1 - 26 - width):
        y = (block.y0 + block.y1) // 2 - 12
        plan.pillars.append(Rectangle(x, y, x + width, y + 24))
