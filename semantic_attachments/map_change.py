"""Which shortest paths a changed map can touch."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isinf, sqrt
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from semantic_attachments._core import Traversability
from semantic_attachments.neighbours import beside
from semantic_attachments.world import Blockade

MapState = tuple[Traversability, tuple[Blockade, ...], NDArray[np.float32] | None]
"""A class of robots' map, the blockades in it, and its length multipliers."""

_MOST_DISTANCES = 20_000_000
"""Above this number of distances, opened cells are represented by their bounding box."""


class Measured(Protocol):
    """What is known of a shortest path (a `Leg`)."""

    @property
    def length(self) -> float:
        """Its length in cells times multiplier."""

    @property
    def path(self) -> NDArray[np.uint32]:
        """(n,) its cells."""

    @property
    def snapped(self) -> tuple[bool, bool]:
        """Whether its ends lie beside the places it joins."""


@dataclass(frozen=True, slots=True)
class MapChange:
    """Cells that paths may no longer use, and cells that they newly may; neighbours included.

    Neighbours belong to both, because a step over a corner depends on the cells beside it.
    """

    closed: NDArray[np.bool_]
    """(height, width)"""
    opened: NDArray[np.bool_]
    """(height, width)"""

    @classmethod
    def between(cls, old: MapState, new: MapState) -> Self | None:
        """The change from one state of a map to another of the same shape, if there is one."""
        (old_map, old_blockades, old_factors), (new_map, new_blockades, new_factors) = old, new
        old_open, new_open = old_map.open(), new_map.open()
        closed, opened = old_open & ~new_open, ~old_open & new_open
        # A stamp may lie on another: its cells count even where a second blockade covers them,
        # because either may be the one that is open for a robot.
        for number, blockade in enumerate(new_blockades):
            if blockade not in old_blockades:
                closed.ravel()[new_map.stamp(number)] = True
        for number, blockade in enumerate(old_blockades):
            if blockade not in new_blockades:
                opened.ravel()[old_map.stamp(number)] = True
        if old_factors is not None or new_factors is not None:
            ones = np.ones(closed.shape, dtype=np.float32)
            rescaled = (ones if old_factors is None else old_factors) != (
                ones if new_factors is None else new_factors
            )
            closed |= rescaled
            opened |= rescaled
        if not closed.any() and not opened.any():
            return None
        return cls(_with_neighbours(closed), _with_neighbours(opened))

    def touches(
        self,
        legs: Sequence[tuple[int, int, Measured]],
        snap_limit_cells: float,
        *,
        any_angle: bool = False,
    ) -> NDArray[np.bool_]:
        """(n,) whether each (first cell, second cell, leg) may have another shortest path now."""
        if not legs:
            return np.zeros(0, dtype=bool)
        touched = self._crosses(legs)
        touched[~touched] = self._may_shorten(
            [leg for leg, hit in zip(legs, touched, strict=True) if not hit], any_angle
        )
        changed = self.closed | self.opened
        reach = int(snap_limit_cells) + 2
        near: dict[int, bool] = {}
        """Whether the map has changed around a cell."""

        def changed_near(cell: int) -> bool:
            known = near.get(cell)
            if known is None:
                row, column = divmod(cell, changed.shape[1])
                rows = slice(max(row - reach, 0), row + reach + 1)
                columns = slice(max(column - reach, 0), column + reach + 1)
                known = near[cell] = bool(changed[rows, columns].any())
            return known

        for index in np.flatnonzero(~touched).tolist():
            first, second, leg = legs[index]
            # A robot that has no way may get one by another beginning of it.
            ends = (True, True) if isinf(leg.length) else leg.snapped
            touched[index] = (ends[0] and changed_near(first)) or (ends[1] and changed_near(second))
        return touched

    def _crosses(self, legs: Sequence[tuple[int, int, Measured]]) -> NDArray[np.bool_]:
        paths = [leg.path for _, _, leg in legs]
        ends = np.cumsum([len(path) for path in paths])
        hits = np.concatenate([[0], np.cumsum(self.closed.ravel()[np.concatenate(paths)])])
        return np.asarray(np.diff(np.concatenate([[0], hits[ends]])) > 0)

    def _may_shorten(
        self, legs: Sequence[tuple[int, int, Measured]], any_angle: bool
    ) -> NDArray[np.bool_]:
        cells = np.flatnonzero(self.opened)
        if cells.size == 0 or not legs:
            return np.zeros(len(legs), dtype=bool)
        lengths = np.array([leg.length for _, _, leg in legs])
        width = self.opened.shape[1]
        places = sorted({cell for first, second, _ in legs for cell in (first, second)})
        number = {cell: index for index, cell in enumerate(places)}
        place_rows, place_columns = np.divmod(np.array(places, dtype=np.int64), width)
        rows, columns = np.divmod(cells, width)
        if len(places) * cells.size > _MOST_DISTANCES:
            rows_away = _outside(place_rows, rows)[:, None]
            columns_away = _outside(place_columns, columns)[:, None]
        else:
            rows_away = np.abs(place_rows[:, None] - rows)
            columns_away = np.abs(place_columns[:, None] - columns)
        if any_angle:
            # Lines may pass opened cells and their neighbours off their centres.
            away = np.maximum(np.hypot(rows_away, columns_away) - 1, 0.0)
        else:
            most, least = np.maximum(rows_away, columns_away), np.minimum(rows_away, columns_away)
            away = most + (sqrt(2) - 1) * least
        # Where there was no way, any opened cell may make one.
        detours = np.zeros(len(legs))
        for index in np.flatnonzero(np.isfinite(lengths)).tolist():
            first, second, _ = legs[index]
            detours[index] = (away[number[first]] + away[number[second]]).min()
        return np.asarray(detours < lengths - 1e-9)


def _with_neighbours(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    return cells | beside(cells) if cells.any() else cells


def _outside(values: NDArray[np.int64], box: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.asarray(np.maximum(np.maximum(box.min() - values, values - box.max()), 0))
