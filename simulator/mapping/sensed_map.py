"""The map that a fleet makes of an unknown building, and what of it the service has been told."""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simulator.mapping.occupancy import JointOccupancyMap
from simulator.occupancy_grid import OccupancyGrid, packed
from simulator.sensors import Scan

_OCCUPIED_FROM = 50
"""percent"""
_BODY_GAP_M = 0.1
"""A beam that ends this near to a team mate's body has met it, and no wall."""


class SensedMap:
    """A joint map of all robots, as cells that are unknown, free or occupied.

    The robots know where they and the others are: what a beam meets of a team mate is left out of
    the map. Terrain is seen with the cells.
    """

    def __init__(self, truth: OccupancyGrid) -> None:
        self._truth = truth
        self._joint = JointOccupancyMap(truth.cells.shape, truth.resolution_m, truth.origin_m)
        self._told = np.full(truth.cells.shape, -1, dtype=np.int8)

    def insert(self, scan: Scan, others: Iterable[tuple[float, float, float]]) -> None:
        """Takes a sweep in; `others` are the team mates' bodies as x, y, radius [m]."""
        ranges_m = np.array(scan.ranges_m)
        x, y, heading_rad = scan.pose
        bearing = heading_rad + np.arange(len(ranges_m)) * (2.0 * np.pi / len(ranges_m))
        end_x, end_y = x + ranges_m * np.cos(bearing), y + ranges_m * np.sin(bearing)
        for other_x, other_y, radius_m in others:
            near = np.hypot(end_x - other_x, end_y - other_y) < radius_m + _BODY_GAP_M
            ranges_m[near] = np.nan
        self._joint.insert(
            Scan(scan.robot, scan.time_s, scan.pose, scan.range_m, ranges_m, scan.blockades)
        )

    def copy(self) -> SensedMap:
        """A map of its own that knows the same, as robots that lose touch with others have."""
        one = copy(self)
        one._joint = self._joint.copy()
        return one

    def merge(self, other: SensedMap) -> None:
        """Takes over what robots that are met have seen; what was told stays as it is."""
        self._joint.merge(other._joint)

    def cells(self) -> NDArray[np.int8]:
        """(rows, columns) -1 unknown, 0 free, 100 occupied."""
        percent = self._joint.cells()
        occupied = np.int8(100) * (percent >= _OCCUPIED_FROM).astype(np.int8)
        return np.where(percent < 0, np.int8(-1), occupied)

    def grid(self) -> OccupancyGrid:
        """The map as known, with the terrain of what has been seen."""
        truth = self._truth
        return OccupancyGrid(
            self.cells(), truth.resolution_m, truth.origin_m, truth.terrain, truth.terrain_classes
        )

    def news(self) -> list[dict[str, Any]]:
        """What has changed since the last time, as `map_patches` of the fleet protocol."""
        cells = self.cells()
        changed = cells != self._told
        if not changed.any():
            return []
        rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
        window = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
        told = np.where(changed[window], cells[window], np.int8(-1))
        patch: dict[str, Any] = {
            "row": int(rows[0]),
            "column": int(columns[0]),
            "width": int(told.shape[1]),
            "height": int(told.shape[0]),
            "cells": packed(told),
        }
        if self._truth.terrain is not None:
            patch["terrain"] = packed(np.ascontiguousarray(self._truth.terrain[window]))
        self._told = cells
        return [patch]

    def known_share(self) -> float:
        """Share of the building's free cells that somebody has seen."""
        free = self._truth.cells == 0
        return float((self._joint.cells()[free] >= 0).mean())
