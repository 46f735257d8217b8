"""What all messages have in common: strict types, no unknown fields, no NaN, frozen."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field


class Message(BaseModel):
    """A JSON object; an unknown field, a number written as text or a NaN is an error."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


Identifier = Annotated[
    str, Field(min_length=1, max_length=64, pattern=r"^[A-Za-z0-9][A-Za-z0-9_.:-]*$")
]
"""Names a robot, target, blockade or type; unique within its mission."""

Coordinate = Annotated[float, Field(ge=-1e6, le=1e6)]
Position = tuple[Coordinate, Coordinate]
"""x, y in the map frame [m]."""

Pose = tuple[Coordinate, Coordinate, Coordinate]
"""x, y in the map frame [m] and the heading [rad], counter-clockwise."""

Seconds = Annotated[float, Field(ge=0.0, le=1e9)]
"""Since the mission began, or a duration [s]."""

Text = Annotated[str, Field(max_length=200)]
