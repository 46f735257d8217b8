"""A maze of 33 x 24 m for marsupial teams: a ring for carriers around a core for rovers.

The thesis's maze (section 3.6.2) is 10.2 rover ranges large: 41 m at 4 m. Its central area can only
be explored by rovers and has several meeting points: here eight openings, two on each side.
"""

from __future__ import annotations

from random import Random

from scenarios.maps.floor_plan import FloorPlan, Rectangle
from scenarios.maps.rooms import open_between
from scenarios.maps.terrain import clutter

CELL = 15
"""side of a cell of the maze, in grid cells of 0.2 m"""
COLUMNS, ROWS = 10, 7
DOOR = 8


def draw(seed: int) -> FloorPlan:
    """Draws the floor of 166 x 120 cells of 0.2 m.

    The outer cells form the ring; the core is a spanning tree of its cells, as a depth-first walk
    draws it, with every sixth wall opened as well so that there is more than one way.
    """
    random = Random(seed)
    plan = FloorPlan("maze", width=166, height=120, resolution_m=0.2)
    rooms: dict[tuple[int, int], int] = {}
    for row in range(ROWS):
        for column in range(COLUMNS):
            x, y = 3 + column * (CELL + 1), 4 + row * (CELL + 1)
            ring = column in (0, COLUMNS - 1) or row in (0, ROWS - 1)
            kind = "corridor" if ring else "core"
            rooms[column, row] = plan.add(kind, Rectangle(x, y, x + CELL, y + CELL))
    core = {cell for cell, room in rooms.items() if plan.spaces[room].kind == "core"}
    for cell in sorted(rooms.keys() - core):
        for other in _neighbours(cell):
            if other in rooms and other not in core and other > cell:
                open_between(plan, rooms[cell], rooms[other], None, None)
    for cell, other in sorted(_tree(core, random)):
        open_between(plan, rooms[cell], rooms[other], DOOR, random)
    for cell, other in _entrances(random):
        open_between(plan, rooms[cell], rooms[other], DOOR, random)
    return clutter(plan, [rooms[cell] for cell in sorted(core)])


def _tree(
    core: set[tuple[int, int]], random: Random
) -> set[tuple[tuple[int, int], tuple[int, int]]]:
    """Pairs of neighbouring cells without a wall between them."""
    start = min(core)
    reached, way = {start}, [start]
    opened: set[tuple[tuple[int, int], tuple[int, int]]] = set()
    while way:
        fresh = [cell for cell in _neighbours(way[-1]) if cell in core and cell not in reached]
        if not fresh:
            way.pop()
            continue
        chosen = random.choice(fresh)
        opened.add((min(way[-1], chosen), max(way[-1], chosen)))
        reached.add(chosen)
        way.append(chosen)
    walls = [
        (cell, other)
        for cell in sorted(core)
        for other in _neighbours(cell)
        if other in core and other > cell and (cell, other) not in opened
    ]
    return opened | set(random.sample(walls, len(walls) // 6))


def _entrances(random: Random) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Two openings on each side, from the ring into the core."""
    columns, rows = range(1, COLUMNS - 1), range(1, ROWS - 1)
    return [
        *(((c, 0), (c, 1)) for c in sorted(random.sample(columns, 2))),
        *(((c, ROWS - 1), (c, ROWS - 2)) for c in sorted(random.sample(columns, 2))),
        *(((0, r), (1, r)) for r in sorted(random.sample(rows, 2))),
        *(((COLUMNS - 1, r), (COLUMNS - 2, r)) for r in sorted(random.sample(rows, 2))),
    ]


def _neighbours(cell: tuple[int, int]) -> list[tuple[int, int]]:
    column, row = cell
    return [(column - 1, row), (column + 1, row), (column, row - 1), (column, row + 1)]
