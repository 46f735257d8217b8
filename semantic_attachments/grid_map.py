"""A grid map of the world: occupancy and terrain classes, with its frame.

Cells follow ROS `nav_msgs/OccupancyGrid`: -1 unknown, 0 free ... 100 occupied; row 0 is at the
bottom (smallest y) and `origin_m` is the lower left corner of cell (0, 0) in the map frame.
"""

import base64
import binascii
import hashlib
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import floor, isfinite
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

PositionM = tuple[float, float]
"""x and y in the map frame [m]."""

ENCODING = "zlib+base64"


@dataclass(frozen=True, eq=False)
class GridMap:
    """An immutable grid map; two maps are equal when their content is.

    Raises:
        ValueError: for cells that are not a grid of -1 ... 100, or a frame that is none.
    """

    cells: NDArray[np.int8]
    """(height, width) occupancy: -1 unknown, 0 free ... 100 occupied."""
    resolution_m: float
    """Edge of a cell [m]."""
    origin_m: PositionM = (0.0, 0.0)
    """Lower left corner of cell (0, 0) in the map frame [m]."""
    terrain: NDArray[np.uint8] | None = None
    """(height, width) index into `terrain_classes`; None where all is of the first class."""
    terrain_classes: tuple[str, ...] = ("default",)
    """Names of the terrain classes, which a robot model lists in `enters`."""

    def __post_init__(self) -> None:
        cells = _frozen_copy(self.cells, np.int8)
        if cells.ndim != 2 or cells.size == 0:
            raise ValueError(f"a grid map needs rows and columns, not cells of shape {cells.shape}")
        if cells.min() < -1 or cells.max() > 100:
            raise ValueError("occupancy is -1 (unknown) or 0 to 100")
        if not (isfinite(self.resolution_m) and self.resolution_m > 0):
            raise ValueError(f"resolution_m is {self.resolution_m}; it is a length above 0")
        if not all(isfinite(coordinate) for coordinate in self.origin_m):
            raise ValueError(f"origin_m is {self.origin_m}; it is a position [m]")
        object.__setattr__(self, "cells", cells)
        object.__setattr__(self, "origin_m", (float(self.origin_m[0]), float(self.origin_m[1])))
        object.__setattr__(self, "terrain_classes", tuple(self.terrain_classes))
        if not self.terrain_classes:
            raise ValueError("terrain_classes is empty; give at least one class")
        if self.terrain is not None:
            terrain = _frozen_copy(self.terrain, np.uint8)
            if terrain.shape != cells.shape:
                raise ValueError(f"terrain has shape {terrain.shape}, cells have {cells.shape}")
            if int(terrain.max()) >= len(self.terrain_classes):
                raise ValueError(
                    f"terrain names class {int(terrain.max())}; "
                    f"there are {len(self.terrain_classes)} classes"
                )
            object.__setattr__(self, "terrain", terrain)

    @property
    def height(self) -> int:
        """Number of rows."""
        return int(self.cells.shape[0])

    @property
    def width(self) -> int:
        """Number of columns."""
        return int(self.cells.shape[1])

    @cached_property
    def digest(self) -> str:
        """Fingerprint of the content: equal maps have equal digests."""
        frame = repr((self.cells.shape, self.resolution_m, self.origin_m, self.terrain_classes))
        content = hashlib.blake2b(frame.encode(), digest_size=16)
        content.update(self.cells.data)
        if self.terrain is not None:
            content.update(self.terrain.data)
        return content.hexdigest()

    def __eq__(self, other: object) -> bool:
        return self is other or (isinstance(other, GridMap) and self.digest == other.digest)

    def __hash__(self) -> int:
        return hash(self.digest)

    def __reduce__(self) -> tuple[Any, ...]:
        members = (self.cells, self.resolution_m, self.origin_m, self.terrain, self.terrain_classes)
        return GridMap, members

    def cell_at(self, position_m: PositionM) -> int | None:
        """Index `row * width + column` of the cell at a position, or None outside the map."""
        column = floor((position_m[0] - self.origin_m[0]) / self.resolution_m)
        row = floor((position_m[1] - self.origin_m[1]) / self.resolution_m)
        if 0 <= row < self.height and 0 <= column < self.width:
            return row * self.width + column
        return None

    def terrain_class_at(self, position_m: PositionM) -> str | None:
        """Class of the terrain at a position; None outside the map."""
        cell = self.cell_at(position_m)
        if cell is None:
            return None
        return self.terrain_classes[0 if self.terrain is None else int(self.terrain.flat[cell])]

    def centres_m(self, cells: Sequence[int] | NDArray[Any]) -> NDArray[np.float64]:
        """(n, 2) centres of cells in the map frame [m]."""
        rows, columns = np.divmod(np.asarray(cells, dtype=np.int64), self.width)
        local = (np.stack([columns, rows], axis=-1) + 0.5) * self.resolution_m
        return np.asarray(local + np.asarray(self.origin_m), dtype=np.float64)

    def cells_near_segment(
        self, segment_m: tuple[PositionM, PositionM], distance_m: float
    ) -> NDArray[np.uint32]:
        """(n,) cells whose centre is within a distance of a segment, ascending."""
        ends = np.asarray(segment_m, dtype=np.float64)
        corner = np.asarray(self.origin_m)
        low = np.floor((ends.min(axis=0) - distance_m - corner) / self.resolution_m).astype(int)
        high = np.floor((ends.max(axis=0) + distance_m - corner) / self.resolution_m).astype(int)
        columns = np.arange(max(low[0], 0), min(high[0] + 1, self.width))
        rows = np.arange(max(low[1], 0), min(high[1] + 1, self.height))
        cells = (rows[:, None] * self.width + columns[None, :]).ravel()
        centres = self.centres_m(cells)
        along = ends[1] - ends[0]
        length2 = float(along @ along)
        share = np.clip((centres - ends[0]) @ along / length2, 0, 1) if length2 > 0 else 0.0
        nearest = ends[0] + np.multiply.outer(share, along) if length2 > 0 else ends[0]
        near = np.linalg.norm(centres - nearest, axis=1) <= distance_m
        return np.asarray(cells[near], dtype=np.uint32)

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Self:
        """A map in the encoding of the fleet protocol.

        Raises:
            ValueError: naming the member that is missing or wrong.
        """
        for member in ("resolution_m", "width", "height", "cells"):
            if member not in document:
                raise ValueError(f"the map has no member {member!r}")
        if document.get("encoding", ENCODING) != ENCODING:
            raise ValueError(f"encoding is {document['encoding']!r}; only {ENCODING!r} is known")
        shape = (int(document["height"]), int(document["width"]))
        terrain = document.get("terrain")
        origin = document.get("origin_m", (0.0, 0.0))
        return cls(
            cells=_unpack(document["cells"], shape, "cells").view(np.int8),
            resolution_m=float(document["resolution_m"]),
            origin_m=(float(origin[0]), float(origin[1])),
            terrain=None if terrain is None else _unpack(terrain, shape, "terrain"),
            terrain_classes=tuple(document.get("terrain_classes", ("default",))),
        )

    def to_json(self) -> dict[str, Any]:
        """The map in the encoding of the fleet protocol."""
        document: dict[str, Any] = {
            "resolution_m": self.resolution_m,
            "origin_m": list(self.origin_m),
            "width": self.width,
            "height": self.height,
            "encoding": ENCODING,
            "cells": _pack(self.cells),
        }
        if self.terrain is not None or self.terrain_classes != ("default",):
            document["terrain_classes"] = list(self.terrain_classes)
        if self.terrain is not None:
            document["terrain"] = _pack(self.terrain)
        return document


def _frozen_copy(array: NDArray[Any], dtype: type[Any]) -> NDArray[Any]:
    given = np.asarray(array)
    frozen = np.array(given, dtype=dtype, order="C")
    if given.dtype != frozen.dtype and not np.array_equal(given, frozen):
        raise ValueError(f"cells of type {given.dtype} do not fit {np.dtype(dtype)}")
    frozen.setflags(write=False)
    return frozen


def _pack(cells: NDArray[Any]) -> str:
    return base64.b64encode(zlib.compress(cells.tobytes(), 6)).decode("ascii")


def _unpack(text: str, shape: tuple[int, int], member: str) -> NDArray[np.uint8]:
    size = shape[0] * shape[1]
    try:
        # One byte more than expected is enough to see that there are too many.
        unpacked = zlib.decompressobj().decompress(base64.b64decode(text, validate=True), size + 1)
    except (binascii.Error, zlib.error, ValueError, TypeError) as error:
        raise ValueError(f"{member} is not {ENCODING}: {error}") from None
    if len(unpacked) != size:
        raise ValueError(f"{member} does not hold width * height = {size} cells")
    return np.frombuffer(unpacked, dtype=np.uint8).reshape(shape)
