"""Which scanner measured, and how it is mounted: a model is good for one such set-up only."""

from __future__ import annotations

import math
from dataclasses import dataclass

HEIGHT_TOLERANCE_M = 0.1
TILT_TOLERANCE_RAD = math.radians(5.0)


@dataclass(frozen=True, slots=True)
class SensorSetup:
    """A laser scanner and its mounting.

    Remission depends on range and incidence angle in a way that each device has for itself, and
    the mounting decides which ranges and angles occur (section 6.3.1).
    """

    scanner: str
    """Model of the scanner, such as `LMS 291-S05`."""
    height_m: float
    """Of the scanner above the ground."""
    tilt_rad: tuple[float, float]
    """Lowest and highest tilt of the scan plane below the horizontal; equal if it is fixed."""

    def mismatch(self, other: SensorSetup) -> str | None:
        """Why a model trained with `other` must not be used with this set-up; None if it may."""
        if self.scanner != other.scanner:
            return f"the scanner is {self.scanner!r}, the model was trained with {other.scanner!r}"
        if abs(self.height_m - other.height_m) > HEIGHT_TOLERANCE_M:
            return (
                f"the scanner is mounted {self.height_m:.2f} m high, "
                f"in training it was {other.height_m:.2f} m"
            )
        pairs = zip(self.tilt_rad, other.tilt_rad, strict=True)
        if any(abs(mine - theirs) > TILT_TOLERANCE_RAD for mine, theirs in pairs):
            here, there = (
                " to ".join(f"{math.degrees(tilt):.0f}" for tilt in setup.tilt_rad)
                for setup in (self, other)
            )
            return f"the scanner is tilted by {here} degrees, in training it was {there} degrees"
        return None
