"""What path costs depend on of a robot: a class of robots, not one of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from types import MappingProxyType
from typing import Any, Self

KINEMATICS = ("disc", "se2", "dubins", "reeds-shepp")
"""Disc: any direction, heading does not matter; se2: any direction, turning meanwhile; dubins: a
car that drives forward only; reeds-shepp: one that reverses, too."""


@dataclass(frozen=True)
class RobotModel:
    """A type of robots.

    Raises:
        ValueError: for a length, speed or duration that is none.
    """

    type: str
    """Name of the robot type."""
    radius_m: float
    """Radius of the disc that contains the robot [m]."""
    speed_m_s: float
    """Travel speed where the terrain does not say otherwise [m/s]."""
    sensor_range_m: float = 5.0
    """Range within which it senses blockades [m]."""
    enters: tuple[str, ...] = ("default",)
    """Terrain classes that it can drive on."""
    capacity: int = 0
    """Rovers it can carry."""
    terrain_speed_m_s: Mapping[str, float] = field(default_factory=dict)
    """Travel speed on terrain classes where it differs from `speed_m_s` [m/s]."""
    dock_duration_s: float = 20.0
    """Time a rover of this type takes to drive onto its carrier [s]."""
    undock_duration_s: float = 10.0
    """Time a rover of this type takes to leave its carrier [s]."""
    clear_speed_factor: float = 1.0
    """How fast it clears: a blockade takes its clear duration divided by this factor."""
    kinematics: str = "disc"
    """How it moves: one of `KINEMATICS`."""
    footprint_m: tuple[tuple[float, float], ...] = ()
    """Corners of its outline around its reference point, x ahead [m]; a disc if there are none."""
    turning_radius_m: float = 1.0
    """Least turning radius of cars [m]."""
    turn_speed_rad_s: float = 1.0
    """Speed of turning on the spot [rad/s]."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "enters", tuple(self.enters))
        corners = tuple((float(x), float(y)) for x, y in self.footprint_m)
        object.__setattr__(self, "footprint_m", corners)
        if self.kinematics not in KINEMATICS:
            raise ValueError(
                f"robot type {self.type}: kinematics is {self.kinematics!r}; "
                f"it is one of {', '.join(KINEMATICS)}"
            )
        speeds = dict(self.terrain_speed_m_s)
        object.__setattr__(self, "terrain_speed_m_s", MappingProxyType(speeds))
        named = {"speed_m_s": self.speed_m_s, "clear_speed_factor": self.clear_speed_factor}
        named |= {
            "turning_radius_m": self.turning_radius_m,
            "turn_speed_rad_s": self.turn_speed_rad_s,
        }
        named |= {f"terrain_speed_m_s of {name}": speed for name, speed in speeds.items()}
        for name, value in named.items():
            if not (isfinite(value) and value > 0):
                raise ValueError(f"robot type {self.type}: {name} is {value}; it must be above 0")
        for name in (
            "radius_m",
            "sensor_range_m",
            "capacity",
            "dock_duration_s",
            "undock_duration_s",
        ):
            value = getattr(self, name)
            if not (isfinite(value) and value >= 0):
                raise ValueError(f"robot type {self.type}: {name} is {value}; it is never negative")

    def __hash__(self) -> int:
        return hash((self.type, self.radius_m, self.speed_m_s, self.enters, self.capacity))

    def __reduce__(self) -> tuple[Any, ...]:
        values = {name: getattr(self, name) for name in self.__dataclass_fields__}
        values["terrain_speed_m_s"] = dict(self.terrain_speed_m_s)
        return _from_members, (values,)

    @classmethod
    def from_json(cls, type_name: str, document: Mapping[str, Any]) -> Self:
        """A robot type of the fleet protocol (`robot_types`); members it does not know are ignored.

        Raises:
            ValueError: naming the member that is missing or wrong.
        """
        for member in ("radius_m", "speed_m_s"):
            if member not in document:
                raise ValueError(f"robot type {type_name}: the member {member!r} is missing")
        known = {k: document[k] for k in cls.__dataclass_fields__ if k != "type" and k in document}
        return cls(type=type_name, **known)


def _from_members(members: dict[str, Any]) -> RobotModel:
    return RobotModel(**members)
