"""A floor plan: rectangular spaces joined by openings, in whole grid cells.

A space's rectangle is its free interior; one cell of wall surrounds it. Two spaces whose interiors
are one cell apart share that wall, and an opening (a door, or the junction of two corridors) is a
run of cells of it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

UNKNOWN, FREE, OCCUPIED = -1, 0, 100

Point = tuple[float, float]
Segment = tuple[Point, Point]


@dataclass(frozen=True)
class Rectangle:
    """Half-open interval of columns [x0, x1) and rows [y0, y1), in cells."""

    x0: int
    y0: int
    x1: int
    y1: int

    @property
    def width(self) -> int:
        return self.x1 - self.x0

    @property
    def height(self) -> int:
        return self.y1 - self.y0

    def grown(self, cells: int) -> Rectangle:
        return Rectangle(self.x0 - cells, self.y0 - cells, self.x1 + cells, self.y1 + cells)


@dataclass(frozen=True)
class Space:
    """A room or a corridor."""

    kind: str
    interior: Rectangle


@dataclass(frozen=True)
class Opening:
    """A run of wall cells without wall, between the spaces with indices `joins`."""

    cells: Rectangle
    joins: tuple[int, int]
    door: bool


@dataclass
class FloorPlan:
    """What a generator draws; `(width, height)` in cells, row 0 at the bottom."""

    name: str
    width: int
    height: int
    resolution_m: float
    spaces: list[Space] = field(default_factory=list)
    openings: list[Opening] = field(default_factory=list)
    pillars: list[Rectangle] = field(default_factory=list)
    terrain: list[tuple[Rectangle, int]] = field(default_factory=list)
    """index into `terrain_classes` of everything that is not of the first class, later ones win"""
    terrain_classes: tuple[str, ...] = ("default",)

    def add(self, kind: str, interior: Rectangle) -> int:
        """Adds a space and returns its index."""
        inside = interior.grown(1)
        if inside.x0 < 0 or inside.y0 < 0 or inside.x1 > self.width or inside.y1 > self.height:
            raise ValueError(
                f"{kind} {interior} leaves the {self.width} x {self.height} cells of the floor"
            )
        self.spaces.append(Space(kind, interior))
        return len(self.spaces) - 1

    def open(self, cells: Rectangle, joins: tuple[int, int], *, door: bool = True) -> None:
        """Takes the wall away in `cells`."""
        self.openings.append(Opening(cells, joins, door))

    def cells(self) -> NDArray[np.int8]:
        """The occupancy grid `(height, width)`: unknown outside, occupied walls, free inside."""
        grid = np.full((self.height, self.width), UNKNOWN, np.int8)
        for space in self.spaces:
            _fill(grid, space.interior.grown(1), OCCUPIED)
        for space in self.spaces:
            _fill(grid, space.interior, FREE)
        for opening in self.openings:
            _fill(grid, opening.cells, FREE)
        for pillar in self.pillars:
            _fill(grid, pillar, OCCUPIED)
        return grid

    def metres(self, column: float, row: float) -> Point:
        """Map frame position [m] of a (fractional) cell coordinate."""
        return (round(column * self.resolution_m, 3), round(row * self.resolution_m, 3))

    def across(self, opening: Opening) -> Segment:
        """The segment [m] from jamb to jamb that closes an opening."""
        box = opening.cells
        if box.width >= box.height:
            middle = (box.y0 + box.y1) / 2
            return self.metres(box.x0, middle), self.metres(box.x1, middle)
        middle = (box.x0 + box.x1) / 2
        return self.metres(middle, box.y0), self.metres(middle, box.y1)


def _fill(grid: NDArray[np.int8], box: Rectangle, value: int) -> None:
    grid[box.y0 : box.y1, box.x0 : box.x1] = value
