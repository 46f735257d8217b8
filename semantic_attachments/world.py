"""The frozen world that attachments see: map, places, robots and blockades at one instant.

Positions are in the map frame [m].
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import hypot, isfinite, sqrt
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.grid_map import GridMap, PositionM
from semantic_attachments.robot_model import RobotModel

__all__ = ["Blockade", "GridMap", "Location", "PositionM", "RobotModel", "World"]

OCCUPIED = 100
OCCUPIED_FROM = 65
"""Occupancy from which a cell is an obstacle, the threshold of map_server."""


@dataclass(frozen=True, slots=True)
class Location:
    """A named place."""

    position_m: PositionM
    blockade: str | None = None
    """The blockade that lies at this place, if any: it is open for a robot on its way here."""
    charger: bool = False
    """Whether batteries can be charged here."""
    unknown_m2: float = 0.0
    """Area that nobody has seen yet and that is expected to be seen from here [m^2]."""


@dataclass(frozen=True, slots=True)
class Blockade:
    """Something that blocks the way along a segment until a robot clears it."""

    id: str
    segment_m: tuple[PositionM, PositionM]
    """Its two ends."""
    clear_duration_s: float
    """Time that clearing takes [s]."""
    thickness_m: float = 0.0
    """Its extent across the segment [m]."""

    def __post_init__(self) -> None:
        coordinates = [value for end in self.segment_m for value in end]
        if not all(isfinite(value) for value in coordinates):
            raise ValueError(f"blockade {self.id}: segment_m is {self.segment_m}")
        for name in ("clear_duration_s", "thickness_m"):
            if not (isfinite(getattr(self, name)) and getattr(self, name) >= 0):
                raise ValueError(f"blockade {self.id}: {name} is {getattr(self, name)}")

    @property
    def centre_m(self) -> PositionM:
        """The middle of its segment."""
        (x0, y0), (x1, y1) = self.segment_m
        return ((x0 + x1) / 2, (y0 + y1) / 2)

    @property
    def length_m(self) -> float:
        """Length of its segment [m]."""
        (x0, y0), (x1, y1) = self.segment_m
        return hypot(x1 - x0, y1 - y0)

    def cells(self, grid: GridMap) -> NDArray[np.uint32]:
        """(n,) the cells of the map that it covers and that are not occupied anyway, ascending.

        Half a cell's diagonal around the segment: that contains every cell the segment passes
        through, so no 8-connected path slips through.
        """
        half_m = max(self.thickness_m / 2, grid.resolution_m * sqrt(0.5) * (1 + 1e-9))
        near = grid.cells_near_segment(self.segment_m, half_m)
        free: NDArray[np.uint32] = near[grid.cells.ravel()[near] < OCCUPIED_FROM]
        return free


@dataclass(frozen=True)
class World:
    """Everything an attachment may know; neither its maps nor its tables can be written.

    Raises:
        ValueError: if a location names a blockade that is not there.
    """

    grid: GridMap
    """The map as known, without blockades."""
    locations: Mapping[str, Location] = field(default_factory=dict)
    """Places by their names in the planning problem."""
    robots: Mapping[str, RobotModel] = field(default_factory=dict)
    """Model of each robot, by its name in the planning problem."""
    blockades: Mapping[str, Blockade] = field(default_factory=dict)
    """Known blockades that are not cleared, by name."""
    version: int = 0
    """Changes whenever anything above does."""

    def __post_init__(self) -> None:
        for name in ("locations", "robots", "blockades"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        for name, location in self.locations.items():
            if location.blockade is not None and location.blockade not in self.blockades:
                raise ValueError(f"location {name} lies at {location.blockade}, no known blockade")

    def __hash__(self) -> int:
        return hash((self.version, self.grid))

    def __reduce__(self) -> tuple[Any, ...]:
        tables = (dict(self.locations), dict(self.robots), dict(self.blockades))
        return World, (self.grid, *tables, self.version)

    def cells_with_blockades(self) -> NDArray[np.int8]:
        """(height, width) occupancy with the known blockades drawn in."""
        drawn = self.grid.cells.copy()
        for blockade in self.blockades.values():
            drawn.ravel()[blockade.cells(self.grid)] = OCCUPIED
        return drawn
