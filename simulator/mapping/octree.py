"""3D occupancy maps (Wurm, chapter 5; Hornung et al., "OctoMap", Autonomous Robots 2013).

Points are metres in the map frame, arrays of shape `(n, 3)`; log odds are natural logarithms. Files
are OctoMap's `.bt` and
`.ot`, so that its viewers and libraries read them.
"""

from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simulator import _core


@dataclass(frozen=True, slots=True)
class SensorModel:
    """Inverse sensor model in log odds; defaults are the thesis's (section 5.5).

    All constants must be multiples of `quantum`, the step of the byte that a voxel is stored in.
    """

    hit: float = 0.85
    """Added where a beam ends."""
    miss: float = -0.4
    """Added where a beam passes."""
    lowest: float = -2.0
    """Lower clamping threshold."""
    highest: float = 3.5
    """Upper clamping threshold."""
    quantum: float = 0.05

    @property
    def constants(self) -> tuple[float, float, float, float, float]:
        """In the order of the native kernel."""
        return (self.quantum, self.hit, self.miss, self.lowest, self.highest)


class RayEnd(IntEnum):
    """How a ray ended."""

    HIT = 0
    UNKNOWN = 1
    RANGE = 2


class MapFileError(ValueError):
    """A file that is no readable OctoMap file; the message says why."""


class MapFullError(MemoryError):
    """The map would have grown beyond its memory limit; it is as it was before."""


Bounds = tuple[ArrayLike, ArrayLike]
"""Lowest and highest corner `(3,)` of a box along the axes of the map frame [m]."""


Region = tuple[tuple[int, int, int], tuple[int, int, int]]
"""Lowest and highest voxel of a box."""


class OctreeMap:
    """Occupancy of space at one resolution, updated scan by scan.

    A voxel is occupied when its log odds are zero or more, free below, and unknown until it is
    observed.

    Args:
        resolution_m: edge of a voxel [m].
        memory_limit_bytes: what would take more is refused with `MapFullError`.
    """

    def __init__(
        self,
        resolution_m: float,
        model: SensorModel | None = None,
        memory_limit_bytes: int | None = None,
    ) -> None:
        self.model = model or SensorModel()
        self._kernel = _core.Octree(resolution_m, self.model.constants, memory_limit_bytes)

    @classmethod
    def read(
        cls,
        path: Path | str,
        model: SensorModel | None = None,
        memory_limit_bytes: int | None = None,
    ) -> "OctreeMap":
        """Reads a `.bt` or `.ot` file.

        Raises:
            MapFileError: names the file and what is wrong with it.
        """
        try:
            return cls.from_bytes(Path(path).read_bytes(), model, memory_limit_bytes)
        except MapFileError as fault:
            raise MapFileError(f"{path}: {fault}") from None

    @classmethod
    def from_bytes(
        cls,
        contents: bytes,
        model: SensorModel | None = None,
        memory_limit_bytes: int | None = None,
    ) -> "OctreeMap":
        """The map in the contents of a `.bt` or `.ot` file.

        Raises:
            MapFileError: says what is wrong with them.
        """
        read = cls.__new__(cls)
        read.model = model or SensorModel()
        try:
            read._kernel = _core.Octree.read(contents, read.model.constants, memory_limit_bytes)
        except ValueError as fault:
            raise MapFileError(str(fault)) from None
        return read

    def write(self, path: Path | str) -> None:
        """Writes `.bt` (free and occupied only, two bits a node) or `.ot` (full log odds), by the
        path's ending.

        Raises:
            ValueError: for another ending, or a map too large for the format.
        """
        path = Path(path)
        path.write_bytes(self.to_bytes(path.suffix))

    def to_bytes(self, ending: str) -> bytes:
        """The contents of a file with the ending `.bt` or `.ot`.

        Raises:
            ValueError: for another ending, or a map too large for the format.
        """
        match ending:
            case ".bt":
                return self._kernel.write_bt()
            case ".ot":
                return self._kernel.write_ot()
        raise ValueError(f"maps are written as .bt or .ot, not {ending or 'no ending'!r}")

    @property
    def resolution_m(self) -> float:
        """Edge of a voxel [m]."""
        return self._kernel.resolution_m

    def insert_scan(
        self,
        origin_m: ArrayLike,
        end_points_m: ArrayLike,
        max_range_m: float | None = None,
        bounds_m: Bounds | None = None,
        threads: int = 1,
    ) -> None:
        """Adds one scan of beams from `origin_m` `(3,)` to `end_points_m` `(n, 3)`.

        Each voxel is updated at most once, end points win over passing beams (section 5.5.1). A
        beam longer than
        `max_range_m` only frees space up to there. With `bounds_m`, lowest and highest corner
        `(3,)` of a
        box, beams that end outside it are left out and the others begin where they enter it. The
        result does not depend on `threads`.

        Raises:
            MapFullError: the map would take more than its limit.
        """
        bounds = None if bounds_m is None else (_triple(bounds_m[0]), _triple(bounds_m[1]))
        try:
            self._kernel.insert_scan(
                _triple(origin_m), _points(end_points_m), max_range_m, bounds, threads
            )
        except MemoryError as refusal:
            raise MapFullError(str(refusal)) from None

    def log_odds(
        self, points_m: ArrayLike, levels: int = 0, combine: Literal["max", "mean"] = "max"
    ) -> NDArray[np.float64]:
        """Log odds `(n,)` at points, NaN where unknown.

        With `levels` > 0, of the octree node that many levels above the voxel, by the largest or
        the mean value
        of its known voxels (eqs. 5.10 and 5.11).
        """
        return self._kernel.log_odds(_points(points_m), levels, combine)

    def cast_rays(
        self,
        origins_m: ArrayLike,
        directions: ArrayLike,
        max_range_m: float,
        through_unknown: bool = False,
        threads: int = 1,
    ) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
        """First occupied voxel along each ray.

        Args:
            origins_m: `(n, 3)`, or `(3,)` for all rays.
            directions: `(n, 3)`, of any length.
            through_unknown: pass unknown voxels as if they were free.

        Returns:
            `RayEnd` of each ray `(n,)` and the centre of its last voxel `(n, 3)` [m].
        """
        origins = np.atleast_2d(np.asarray(origins_m, dtype=np.float32))
        return self._kernel.cast_rays(
            np.ascontiguousarray(origins),
            _points(directions),
            max_range_m,
            through_unknown,
            threads,
        )

    def information_gain(
        self,
        origins_m: ArrayLike,
        directions: ArrayLike,
        max_range_m: float,
        bounds_m: Bounds | None = None,
        threads: int = 1,
    ) -> NDArray[np.float64]:
        """Expected reduction of entropy `(v,)` [nat] by a measurement at each viewpoint.

        Beams pass free voxels, end at occupied ones and are reflected with uniform probability in
        unknown ones; only those count (section 5.4, eq. 5.30).

        Args:
            origins_m: `(v, 3)`.
            directions: `(v, r, 3)`, the beams of each viewpoint.
            bounds_m: only voxels whose centre lies in this box count.
        """
        beams = np.asarray(directions, dtype=np.float32)
        if beams.ndim != 3 or beams.shape[2] != 3:
            raise ValueError(f"directions have shape {beams.shape}; expected (v, r, 3)")
        return self._kernel.information_gain(
            _points(origins_m),
            np.ascontiguousarray(beams.reshape(-1, 3)),
            max_range_m,
            self._region(bounds_m),
            threads,
        )

    def known_voxels(
        self, bounds_m: Bounds | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Centres `(n, 3)` [m] and log odds `(n,)` of all observed voxels, in a fixed order.

        With `bounds_m`, of those whose centre lies in a box.
        """
        keys, log_odds = self._kernel.known_voxels(self._region(bounds_m))
        return (keys.astype(np.float64) + 0.5) * self.resolution_m, log_odds

    def occupied_voxels(self, bounds_m: Bounds | None = None) -> NDArray[np.float64]:
        """Centres `(n, 3)` [m] of all occupied voxels, or of those whose centre lies in a box."""
        centres, log_odds = self.known_voxels(bounds_m)
        return centres[log_odds >= 0]

    def leaves(
        self,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Centres `(n, 3)` [m], edges `(n,)` [m] and log odds `(n,)` of the pruned tree's leaves.

        Raises:
            ValueError: if the map is too large for a tree of 16 levels.
        """
        corners, edges, log_odds = self._kernel.leaves()
        centres = (corners + edges[:, None] / 2) * self.resolution_m
        return centres, edges.astype(np.float64) * self.resolution_m, log_odds

    def column_maxima(
        self,
        low_m: float,
        high_m: float,
        columns: tuple[tuple[int, int], tuple[int, int]] | None = None,
    ) -> tuple[tuple[int, int], NDArray[np.float32]]:
        """The largest log odds in each column of the voxels whose centres lie in a height band.

        Args:
            low_m: lower border of the band, z in the map frame.
            high_m: upper border.
            columns: lowest and highest x and y in voxels; the known part of the map if not given.

        Returns:
            x and y of the first column in voxels, and `(rows, columns)`, row 0 at the smallest y,
            NaN where the band is unknown.
        """
        low, high = (round(z / self.resolution_m) for z in (low_m, high_m))
        (x, y), maxima = self._kernel.project(low, max(high - 1, low), columns)
        return (x, y), maxima

    def forget_outside(self, bounds_m: Bounds) -> None:
        """Forgets what lies outside a box, in whole bricks of 8 x 8 x 8 voxels.

        A robot that maps only its surroundings holds a bounded amount for ever.
        """
        self._kernel.forget_outside(*self._corners(bounds_m))

    def set_log_odds(self, points_m: ArrayLike, log_odds: ArrayLike) -> None:
        """Overwrites voxels; NaN makes one unknown.

        Raises:
            ValueError: a point is not finite or lies beyond the map's reach.
            MapFullError: the map would take more than its limit; points before are written.
        """
        keys = np.floor(np.asarray(points_m, dtype=np.float64) / self.resolution_m)
        if not (np.abs(keys) < 2**31).all():
            raise ValueError("a point is not finite or lies beyond the map's reach")
        try:
            self._kernel.set_voxels(
                np.ascontiguousarray(keys.astype(np.int32)), np.asarray(log_odds, dtype=np.float64)
            )
        except MemoryError as refusal:
            raise MapFullError(str(refusal)) from None

    def add_channel(self, name: str, model: SensorModel) -> None:
        """Gives each voxel a further log-odds value, such as vegetation (eq. 6.18)."""
        self._kernel.add_channel(name, model.constants)

    def update_channel(self, name: str, points_m: ArrayLike, hits: ArrayLike) -> None:
        """Adds one measurement a point `(n, 3)`: positive evidence where `hits` `(n,)` is true.

        Raises:
            KeyError: if the channel was not added.
            MapFullError: the map would take more than its limit; points before are counted.
        """
        try:
            self._kernel.update_channel(name, _points(points_m), np.asarray(hits, dtype=np.bool_))
        except MemoryError as refusal:
            raise MapFullError(str(refusal)) from None

    def add_to_channel(self, name: str, points_m: ArrayLike, log_odds: ArrayLike) -> None:
        """Adds one measurement a point `(n, 3)` whose log odds `(n,)` are its own (eq. 6.18).

        The sum is clamped to the channel's thresholds; NaN says nothing.

        Raises:
            KeyError: if the channel was not added.
            MapFullError: the map would take more than its limit; points before are counted.
        """
        try:
            self._kernel.add_to_channel(
                name, _points(points_m), np.asarray(log_odds, dtype=np.float64)
            )
        except MemoryError as refusal:
            raise MapFullError(str(refusal)) from None

    def channel_log_odds(self, name: str, points_m: ArrayLike) -> NDArray[np.float64]:
        """A channel's log odds `(n,)` at points, NaN where it was never measured."""
        return self._kernel.channel_log_odds(name, _points(points_m))

    def memory_bytes(self) -> int:
        """Bytes that the map holds."""
        return self._kernel.memory_bytes()

    def node_count(self) -> int:
        """Nodes of the losslessly pruned octree, as OctoMap counts them."""
        return self._kernel.node_count()

    def unpruned_counts(self) -> tuple[int, int]:
        """Leaves and inner nodes that the octree would have without pruning."""
        return self._kernel.unpruned_counts()

    def brick_counts(self) -> tuple[int, int]:
        """Bricks of 8 x 8 x 8 voxels, and those of them that are not collapsed to one value."""
        return self._kernel.brick_counts()

    def _region(self, bounds_m: Bounds | None) -> Region | None:
        return None if bounds_m is None else self._corners(bounds_m)

    def _corners(self, bounds_m: Bounds) -> Region:
        """The voxels whose centres lie in a box."""
        low, high = (np.asarray(corner, np.float64) / self.resolution_m for corner in bounds_m)
        reach = 2**23 - 1
        first = np.clip(np.ceil(low - 0.5), -reach, reach).astype(int).tolist()
        last = np.clip(np.floor(high - 0.5), -reach, reach).astype(int).tolist()
        return (first[0], first[1], first[2]), (last[0], last[1], last[2])


def _triple(point: ArrayLike) -> tuple[float, float, float]:
    x, y, z = np.asarray(point, dtype=np.float32).tolist()
    return (x, y, z)


def _points(points: ArrayLike) -> NDArray[np.float32]:
    array = np.ascontiguousarray(points, dtype=np.float32)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"points have shape {array.shape}; expected (n, 3)")
    return array
