"""Occupancy grids as they travel, and as planning sees them."""

import base64
import binascii
import zlib

import numpy as np
from numpy.typing import NDArray

from semantic_attachments.world import GridMap, RobotModel
from service.messages.base import Position
from service.messages.map_grid import MapMessage
from service.messages.mission import CreateMission

OCCUPIED_FROM = 65
"""The occupancy from which map_server calls a cell occupied by default [percent]."""


class MapError(ValueError):
    """A map that cannot be read; `field` names the part at fault."""

    def __init__(self, field: str, message: str) -> None:
        super().__init__(message)
        self.field = field


def inflate(text: str, size: int, field: str) -> bytes:
    """`size` bytes from zlib in base64; never unpacks more than that.

    Raises:
        MapError: it holds something else.
    """
    try:
        packed = base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError) as error:
        raise MapError(field, f"is not base64: {error}") from None
    reader = zlib.decompressobj()
    try:
        cells = reader.decompress(packed, size + 1)
    except zlib.error as error:
        raise MapError(field, f"is not zlib data: {error}") from None
    if len(cells) != size:
        found = "more" if len(cells) > size else str(len(cells))
        raise MapError(field, f"holds {found} cells; width * height is {size}")
    return cells


def read_cells(message: MapMessage, max_cells: int) -> NDArray[np.int8]:
    """Occupancy, shape (height, width), row 0 at the smallest y.

    -1 is unknown, 0 free, 100 occupied.

    Raises:
        MapError: with the field that is wrong.
    """
    size = message.width * message.height
    if size > max_cells:
        raise MapError("width", f"width * height is {size}; this server accepts {max_cells} cells")
    cells = np.frombuffer(inflate(message.cells, size, "cells"), dtype=np.int8)
    if cells.min() < -1 or cells.max() > 100:
        wrong = int(np.flatnonzero((cells < -1) | (cells > 100))[0])
        raise MapError("cells", f"cell {wrong} is {cells[wrong]}; -1 and 0 to 100 are cells")
    return cells.reshape(message.height, message.width)


def read_terrain(message: MapMessage) -> NDArray[np.uint8] | None:
    """Terrain class indices, shape (height, width), or None if there is one class only."""
    if message.terrain is None:
        return None
    size = message.width * message.height
    terrain = np.frombuffer(inflate(message.terrain, size, "terrain"), dtype=np.uint8)
    if terrain.max() >= len(message.terrain_classes):
        raise MapError(
            "terrain",
            f"names class {int(terrain.max())}; there are {len(message.terrain_classes)} classes",
        )
    return terrain.reshape(message.height, message.width)


def write_cells(cells: NDArray[np.int8] | NDArray[np.uint8]) -> str:
    """Cells in the encoding of the protocol."""
    return base64.b64encode(zlib.compress(cells.tobytes(), 6)).decode("ascii")


def cell_of(message: MapMessage, position_m: Position) -> tuple[int, int] | None:
    """Row and column of a position in the map frame, or None outside the map."""
    column = int(np.floor((position_m[0] - message.origin_m[0]) / message.resolution_m))
    row = int(np.floor((position_m[1] - message.origin_m[1]) / message.resolution_m))
    if 0 <= row < message.height and 0 <= column < message.width:
        return row, column
    return None


def grid_map(message: MapMessage, max_cells: int) -> GridMap:
    """The map that planning works on.

    Raises:
        MapError: with the field that is wrong.
    """
    return GridMap(
        cells=read_cells(message, max_cells),
        resolution_m=message.resolution_m,
        origin_m=message.origin_m,
        terrain=read_terrain(message),
        terrain_classes=tuple(message.terrain_classes),
    )


def robot_models(request: CreateMission) -> dict[str, RobotModel]:
    """The model of each robot type."""
    return {
        name: RobotModel(
            type=name,
            radius_m=kind.radius_m,
            speed_m_s=kind.speed_m_s,
            sensor_range_m=kind.sensor_range_m,
            enters=tuple(kind.enters),
            capacity=kind.capacity,
            dock_duration_s=kind.dock_duration_s,
            undock_duration_s=kind.undock_duration_s,
        )
        for name, kind in request.robot_types.items()
    }
