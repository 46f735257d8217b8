"""Terrain classes for the coordination service: in a mission's map, and as patches of a report.

Robot types list the classes that they enter (docs/fleet-protocol.md): `paved` is for all,
`vegetation` for those that may touch grass, and so is `verge`, the pavement's edge where the centre
of a robot of a certain radius would have wheels on the grass.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from simulator.occupancy_grid import packed
from simulator.vegetation.terrain_grid import FREE, TERRAIN_CLASSES, UNKNOWN, TerrainGrid

PATCH_CELLS = 64
"""Patches are cut from the map in blocks of this many cells in width and height."""


def mission_map(grid: TerrainGrid, verge_m: float = 0.0) -> dict[str, Any]:
    """The member `map` of `POST /v1/missions`."""
    rows, columns = grid.cells.shape
    return {
        "resolution_m": grid.resolution_m,
        "origin_m": list(grid.origin_m),
        "width": columns,
        "height": rows,
        "encoding": "zlib+base64",
        "cells": packed(grid.cells),
        "terrain": packed(grid.terrain(verge_m)),
        "terrain_classes": list(TERRAIN_CLASSES),
    }


def map_patches(
    grid: TerrainGrid, before: TerrainGrid | None = None, verge_m: float = 0.0
) -> list[dict[str, Any]]:
    """The member `map_patches` of a report: what is known now and was not, or was otherwise.

    Both grids must be of the same place; cells that are unknown now are never sent as news.

    Raises:
        ValueError: `before` is a grid of another place.
    """
    news = grid.cells != UNKNOWN
    if before is not None:
        if (before.cells.shape, before.origin_m) != (grid.cells.shape, grid.origin_m):
            raise ValueError("both grids must be of the same place: same shape and origin_m")
        same = (before.cells == grid.cells) & (before.terrain(verge_m) == grid.terrain(verge_m))
        news &= ~same
    patches = []
    rows, columns = grid.cells.shape
    for row in range(0, rows, PATCH_CELLS):
        for column in range(0, columns, PATCH_CELLS):
            block = news[row : row + PATCH_CELLS, column : column + PATCH_CELLS]
            if block.any():
                patches.append(_patch(grid, grid.terrain(verge_m), block, row, column))
    return patches


def _patch(
    grid: TerrainGrid, terrain: NDArray[np.uint8], news: NDArray[np.bool_], row: int, column: int
) -> dict[str, Any]:
    """The smallest rectangle of a block that holds all its news."""
    own_rows, own_columns = np.flatnonzero(news.any(axis=1)), np.flatnonzero(news.any(axis=0))
    row, rows = row + int(own_rows[0]), int(own_rows[-1] - own_rows[0]) + 1
    column, columns = column + int(own_columns[0]), int(own_columns[-1] - own_columns[0]) + 1
    window = (slice(row, row + rows), slice(column, column + columns))
    return {
        "row": row,
        "column": column,
        "width": columns,
        "height": rows,
        "cells": packed(grid.cells[window]),
        "terrain": packed(terrain[window]),
    }


def terrain_segments(
    grid: TerrainGrid, least_area_m2: float = 1.0, verge_m: float = 0.0
) -> tuple[NDArray[np.int32], list[str]]:
    """Connected pieces of one terrain class: the segments that only some robots may enter.

    Returns `(rows, columns)` numbers from 1, 0 where the ground is unknown, occupied or its piece
    is smaller than `least_area_m2`, and the class of each segment.
    """
    labels = np.zeros(grid.cells.shape, np.int32)
    classes: list[str] = []
    terrain = grid.terrain(verge_m)
    for index, name in enumerate(TERRAIN_CLASSES):
        own = (grid.cells == FREE) & (terrain == index)
        pieces, count = ndimage.label(own)
        areas = np.bincount(pieces.ravel(), minlength=count + 1) * grid.resolution_m**2
        for piece in range(1, count + 1):
            if areas[piece] >= least_area_m2:
                classes.append(name)
                labels[pieces == piece] = len(classes)
    return labels, classes
