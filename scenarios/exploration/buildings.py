"""Buildings to explore: the truth, and a segmentation into rooms and corridors made by hand."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenarios.maps.floor_plan import FREE, OCCUPIED, FloorPlan, Segment
from scenarios.maps.generators import GENERATORS
from simulator.occupancy_grid import OccupancyGrid


@dataclass(frozen=True)
class Building:
    """What the robots do not know."""

    name: str
    map_seed: int
    truth: OccupancyGrid
    rooms: NDArray[np.int32] | None
    """(rows, columns) number of the room or corridor of each cell, from 1; 0 elsewhere"""
    doorways_m: tuple[Segment, ...] = ()
    """from jamb to jamb, in the map frame"""


def generated(name: str, map_seed: int) -> Building:
    """A building drawn by a generator of `scenarios.maps`; its plan knows rooms and doorways."""
    plan = GENERATORS[name][0](map_seed)
    truth = OccupancyGrid(plan.cells(), plan.resolution_m, (0.0, 0.0))
    doors = tuple(plan.across(opening) for opening in plan.openings if opening.door)
    return Building(name, map_seed, truth, rooms_of(plan), doors)


def rooms_of(plan: FloorPlan) -> NDArray[np.int32]:
    """(height, width) number of the space that each cell lies in; openings belong to one side."""
    rooms = np.zeros((plan.height, plan.width), dtype=np.int32)
    for opening in plan.openings:
        box = opening.cells
        rooms[box.y0 : box.y1, box.x0 : box.x1] = opening.joins[0] + 1
    for number, space in enumerate(plan.spaces, 1):
        box = space.interior
        rooms[box.y0 : box.y1, box.x0 : box.x1] = number
    return rooms


def scanned(
    name: str,
    cells: NDArray[np.int8],
    resolution_m: float,
    doorways_m: tuple[Segment, ...] = (),
) -> Building:
    """A real building's map; rooms are what its labelled doorways cut it into."""
    truth = OccupancyGrid(cells, resolution_m, (0.0, 0.0))
    rooms = rooms_between(cells == FREE, resolution_m, doorways_m) if doorways_m else None
    return Building(name, 0, truth, rooms, doorways_m)


def rooms_between(
    free: NDArray[np.bool_], resolution_m: float, doorways_m: tuple[Segment, ...]
) -> NDArray[np.int32]:
    """(rows, columns) parts of the free space that are left when all doorways are shut."""
    from service.coordination.segmentation.partition import Cut, partition

    def cell(x: float, y: float) -> tuple[int, int]:
        rows, columns = free.shape
        return (
            min(max(int(y / resolution_m), 0), rows - 1),
            min(max(int(x / resolution_m), 0), columns - 1),
        )

    lines: list[Cut] = []
    for (x0, y0), (x1, y1) in doorways_m:
        middle = cell((x0 + x1) / 2, (y0 + y1) / 2)
        lines.append((cell(x0, y0), middle, cell(x1, y1)))
    return partition(free, lines)


def read_carmen_map(path: Path, resolution_m: float, coarsened_to_m: float) -> NDArray[np.int8]:
    """A grid map drawn as an image: black is occupied, white free, grey unknown.

    A coarser cell is occupied if any of its pixels is, then free if most of them are.
    """
    from PIL import Image

    with Image.open(path) as image:
        shade = np.asarray(image.convert("L"))[::-1]
    factor = round(coarsened_to_m / resolution_m)
    rows, columns = shade.shape[0] // factor, shade.shape[1] // factor
    blocks = shade[: rows * factor, : columns * factor].reshape(rows, factor, columns, factor)
    occupied = (blocks < 64).any(axis=(1, 3))
    free = (blocks > 192).mean(axis=(1, 3)) >= 0.5
    cells = np.full((rows, columns), -1, dtype=np.int8)
    cells[free] = FREE
    cells[occupied] = OCCUPIED
    return cells
