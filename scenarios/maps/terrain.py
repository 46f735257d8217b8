"""Terrain of a floor for marsupial teams: what carriers drive on, and what only rovers enter."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from scenarios.maps.floor_plan import FloorPlan, Rectangle

CLASSES = ("open", "cluttered", "threshold")
OPEN, CLUTTERED, THRESHOLD = range(3)
THRESHOLD_M = 1.6
"""how far the threshold reaches in front of a door: there carriers and rovers meet"""


def clutter(plan: FloorPlan, spaces: Sequence[int]) -> FloorPlan:
    """Makes these spaces, and the doors between them, terrain for rovers only; returns the plan."""
    chosen = set(spaces)
    plan.terrain_classes = CLASSES
    plan.terrain = [(plan.spaces[k].interior.grown(1), CLUTTERED) for k in sorted(chosen)]
    for opening in plan.openings:
        inside = [space in chosen for space in opening.joins]
        if any(inside) and not all(inside):
            outside = opening.joins[inside.index(False)]
            place = _in_front(plan, opening.cells, plan.spaces[outside].interior)
            plan.terrain.append((place, THRESHOLD))
    return plan


def terrain_cells(plan: FloorPlan) -> NDArray[np.uint8] | None:
    """`(height, width)` index into the plan's terrain classes; None where all is of one class."""
    if not plan.terrain:
        return None
    grid = np.zeros((plan.height, plan.width), np.uint8)
    for box, terrain_class in plan.terrain:
        grid[box.y0 : box.y1, box.x0 : box.x1] = terrain_class
    return grid


def _in_front(plan: FloorPlan, door: Rectangle, outside: Rectangle) -> Rectangle:
    """The part of the space outside that lies before a door."""
    reach = round(THRESHOLD_M / plan.resolution_m)
    around = door.grown(reach)
    return Rectangle(
        max(around.x0, outside.x0) if door.width <= door.height else door.x0,
        max(around.y0, outside.y0) if door.width > door.height else door.y0,
        min(around.x1, outside.x1) if door.width <= door.height else door.x1,
        min(around.y1, outside.y1) if door.width > door.height else door.y1,
    )
