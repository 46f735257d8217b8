"""Samples a drawing of a building (dark lines on light paper) to an occupancy grid."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from scenarios.maps.floor_plan import FREE, OCCUPIED, UNKNOWN, Point
from scenarios.maps.free_space import component_at, components

DARK = 128
"""grey value below which a pixel belongs to a wall"""


def sample(
    image: Path, size_m: tuple[float, float], resolution_m: float, inside_m: Point | None = None
) -> NDArray[np.int8]:
    """The grid `(height, width)`; a cell is a wall where any dark pixel falls into it.

    Args:
        size_m: width and height of what the whole image shows.
        inside_m: a point of the building; free space that is not connected with it becomes unknown.
    """
    with Image.open(image) as picture:
        dark = np.asarray(picture.convert("L")) < DARK
    pixel_rows, pixel_columns = dark.shape
    width, height = (round(extent / resolution_m) for extent in size_m)
    rows, columns = np.nonzero(dark)
    cells = np.full((height, width), FREE, np.int8)
    cells[height - 1 - rows * height // pixel_rows, columns * width // pixel_columns] = OCCUPIED
    if inside_m is not None:
        labels = components(cells, resolution_m, 0.0)
        inside = component_at(labels, resolution_m, inside_m)
        if inside == 0:
            raise ValueError(f"inside_m = {list(inside_m)} is on a wall of {image.name}")
        cells[(cells == FREE) & (labels != inside)] = UNKNOWN
    return cells
