"""Floors for the experiments: an office building floor by floor, and two 130 m corridors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.occupancy_grid import OccupancyGrid

Waypoints = tuple[tuple[float, float], ...]
RESOLUTION_M = 0.05


class _Canvas:
    """Everything is wall until it is hollowed out."""

    def __init__(self, width_m: float, height_m: float) -> None:
        shape = (round(height_m / RESOLUTION_M), round(width_m / RESOLUTION_M))
        self.walls: NDArray[np.bool_] = np.ones(shape, dtype=np.bool_)

    def fill(self, low: tuple[float, float], high: tuple[float, float], *, wall: bool) -> None:
        (x0, y0), (x1, y1) = low, high
        rows = slice(round(y0 / RESOLUTION_M), round(y1 / RESOLUTION_M))
        columns = slice(round(x0 / RESOLUTION_M), round(x1 / RESOLUTION_M))
        self.walls[rows, columns] = wall

    def grid(self) -> OccupancyGrid:
        cells = np.where(self.walls, np.int8(100), np.int8(0))
        return OccupancyGrid(cells, RESOLUTION_M, (0.0, 0.0))


def office_floor(
    building_seed: int, floor: int, rooms: int = 7, share_open: float = 0.6
) -> tuple[OccupancyGrid, Waypoints]:
    """A floor of an office building: the walls are the building's, doors and furniture its own.

    Returns:
        the floor, and waypoints of a drive through corridor, open rooms and hall.
    """
    building = np.random.default_rng(building_seed)
    own = np.random.default_rng([building_seed, floor])
    widths = building.uniform(3.2, 6.0, (2, rooms))
    depths = building.uniform(4.0, 5.5, 2)
    length = float(max(widths.sum(axis=1))) + 0.2 * (rooms + 2) + 9.0
    corridor_low = 0.4 + depths[0] + 0.2
    corridor_high = corridor_low + 2.2
    canvas = _Canvas(length + 0.8, corridor_high + 0.2 + depths[1] + 0.4)
    canvas.fill((0.4, corridor_low), (length + 0.4, corridor_high), wall=False)
    # The hall with lifts at the far end, the same on every floor.
    hall = length - 8.0
    canvas.fill((hall, 0.6), (length + 0.2, corridor_low), wall=False)
    canvas.fill((hall + 2.0, 2.0), (hall + 4.4, 3.2), wall=True)
    canvas.fill((hall + 6.0, 1.0), (hall + 6.4, 1.4), wall=True)
    middle = 0.5 * (corridor_low + corridor_high)
    stops: list[tuple[float, float]] = [(1.2, middle)]
    visits: list[tuple[float, list[tuple[float, float]]]] = []
    for side in (0, 1):
        x = 0.4
        for room in range(rooms):
            width = float(widths[side, room])
            if x + width > (hall - 0.3 if side == 0 else length):
                break
            y0 = corridor_low - 0.2 - depths[0] if side == 0 else corridor_high + 0.2
            y1 = y0 + depths[side]
            canvas.fill((x, y0), (x + width, y1), wall=False)
            door = x + 0.5 * width
            if own.random() < share_open:
                low, high = (y1, corridor_low) if side == 0 else (corridor_high, y0)
                canvas.fill((door - 0.55, low), (door + 0.55, high), wall=False)
                centre = 0.5 * (y0 + y1)
                visits.append((door, [(door, middle), (door, centre), (door, middle)]))
            _furnish(canvas, own, (x, y0), (x + width, y1), side)
            x += width + 0.2
    for _, places in sorted(visits):
        stops.extend(places)
    stops += [(length - 4.0, middle), (hall + 1.0, 1.6), (hall + 5.2, 2.4), (1.2, middle)]
    return canvas.grid(), tuple(stops)


def _furnish(
    canvas: _Canvas,
    random: np.random.Generator,
    low: tuple[float, float],
    high: tuple[float, float],
    side: int,
) -> None:
    """Cupboards along the wall away from the door, and in the corners."""
    for _ in range(int(random.integers(1, 4))):
        width, depth = random.uniform(0.5, 1.4), random.uniform(0.3, 0.7)
        x = random.uniform(low[0], high[0] - width)
        if side == 0:
            canvas.fill((x, low[1]), (x + width, low[1] + depth), wall=True)
        else:
            canvas.fill((x, high[1] - depth), (x + width, high[1]), wall=True)


def corridor_floor(
    featureless: bool, seed: int = 51, length_m: float = 130.0
) -> tuple[OccupancyGrid, Waypoints, tuple[tuple[float, float], tuple[float, float]]]:
    """A floor of two corridors that meet at a lift, with staircases at both ends (4.5.5).

    Args:
        featureless: bare corridor walls, as on floor B, instead of doors in their niches.
        seed: places the niches.
        length_m: between the staircases' far walls.

    Returns:
        the floor, waypoints of a drive up and down, and the ends between which the length counts.
    """
    random = np.random.default_rng(seed)
    width, low = 2.4, 4.5
    high = low + width
    canvas = _Canvas(length_m + 1.0, high + 4.5)
    x0, x1 = 0.5, 0.5 + length_m
    canvas.fill((x0, low), (x1, high), wall=False)
    # Staircases: unlike one another, alike on every floor.
    canvas.fill((x0, high), (x0 + 3.2, high + 3.0), wall=False)
    canvas.fill((x0 + 1.2, high + 0.8), (x0 + 1.6, high + 3.0), wall=True)
    canvas.fill((x1 - 4.5, low - 2.6), (x1, low), wall=False)
    canvas.fill((x1 - 3.0, low - 2.6), (x1 - 2.6, low - 1.0), wall=True)
    canvas.fill((x1 - 1.2, high), (x1, high + 1.4), wall=False)
    # The lift in the middle.
    middle = 0.5 * (x0 + x1)
    canvas.fill((middle - 3.5, low - 3.2), (middle + 3.5, low), wall=False)
    canvas.fill((middle - 1.0, low - 3.2), (middle + 1.4, low - 1.6), wall=True)
    canvas.fill((middle + 1.0, high), (middle + 2.6, high + 2.0), wall=False)
    if not featureless:
        x = x0 + 6.0
        while x < x1 - 7.0:
            if abs(x - middle) > 6.0:
                niche = random.uniform(0.8, 1.6)
                depth = random.uniform(0.3, 1.0)
                if random.random() < 0.5:
                    canvas.fill((x, high), (x + niche, high + depth), wall=False)
                else:
                    canvas.fill((x, low - depth), (x + niche, low), wall=False)
            x += random.uniform(2.0, 4.5)
    y = 0.5 * (low + high)
    stops = (
        (middle - 2.0, low - 1.0),
        (middle - 2.0, y),
        (x0 + 2.4, y),
        (x0 + 2.4, high + 0.8),
        (x0 + 0.8, high + 2.0),
        (x0 + 2.4, y),
        (x0 + 6.0, y),
        (x0 + 1.2, y),
        (middle, y),
        (x1 - 2.0, y),
        (x1 - 3.8, low - 1.0),
        (x1 - 0.6, high + 0.5),
        (x1 - 6.0, y),
        (x1 - 1.8, low - 1.8),
        (x1 - 3.8, y),
        (middle, y),
        (middle - 2.0, low - 1.0),
    )
    return canvas.grid(), stops, ((x0, y), (x1, y))
