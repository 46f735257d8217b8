"""Occupancy grids as they travel."""

from typing import Annotated, Literal

from pydantic import Field

from service.messages.base import Coordinate, Identifier, Message


class MapMessage(Message):
    """An occupancy grid: `int8` cells from the bottom row, zlib in base64."""

    resolution_m: Annotated[float, Field(ge=0.001, le=100.0)]
    origin_m: tuple[Coordinate, Coordinate]
    width: Annotated[int, Field(ge=1, le=100_000)]
    height: Annotated[int, Field(ge=1, le=100_000)]
    encoding: Literal["zlib+base64"] = "zlib+base64"
    cells: str
    terrain: str | None = None
    """`uint8` cells in the same encoding: an index into `terrain_classes`."""
    terrain_classes: list[Identifier] = Field(
        default_factory=lambda: ["default"], min_length=1, max_length=255
    )
