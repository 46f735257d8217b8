"""Native kernels of the simulator."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

__version__: str

_Point = tuple[float, float]
_Segment = tuple[float, float, float, float]
_Disc = tuple[float, float, float]

Constants: TypeAlias = tuple[float, float, float, float, float]
"""Quantum, hit, miss, lowest, highest: log odds."""
Triple: TypeAlias = tuple[float, float, float]

class Floor:
    """Walls on a grid, row 0 at the bottom; positions in the map frame [m]."""

    def __init__(self, walls: NDArray[np.bool_], resolution_m: float, origin_m: _Point) -> None: ...
    def forbidding(self, forbidden: NDArray[np.bool_]) -> Floor: ...
    def is_forbidden(self, x: float, y: float) -> bool: ...
    def clearance_field(self) -> NDArray[np.float32]: ...
    def clearance(self, x: float, y: float, limit_m: float) -> float: ...
    def leg_is_clear(
        self, from_x: float, from_y: float, to_x: float, to_y: float, radius_m: float
    ) -> bool: ...
    def scan(
        self,
        x: float,
        y: float,
        heading_rad: float,
        range_m: float,
        beams: int,
        blockades: list[_Segment],
        robots: list[_Disc],
    ) -> tuple[NDArray[np.float32], list[int]]: ...
    def route(
        self,
        start: _Point,
        goals: list[_Point],
        radius_m: float,
        margin_m: float,
        comfort_m: float,
        blockades: list[_Segment],
        robots: list[_Disc],
    ) -> list[_Point] | None: ...
    def approaches(
        self,
        obstacle: _Segment,
        radius_m: float,
        margin_m: float,
        reach_m: float,
        blockades: list[_Segment],
    ) -> list[_Point]: ...
    def refuges(
        self,
        start: _Point,
        polyline: list[_Point],
        apart_m: float,
        most: int,
        radius_m: float,
        margin_m: float,
        blockades: list[_Segment],
        robots: list[_Disc],
    ) -> list[_Point]: ...
    def timed_route(
        self,
        start: _Point,
        goals: list[_Point],
        motions: list[tuple[list[_Point], float]],
        speed_m_s: float,
        period_s: float,
        horizon_s: float,
        radius_m: float,
        margin_m: float,
        blockades: list[_Segment],
        robots: list[_Disc],
    ) -> list[tuple[float, float, float]] | None: ...

class OccupancyMap:
    """Log odds of occupation on a grid, row 0 at the bottom."""

    def __init__(
        self,
        shape: tuple[int, int],
        resolution_m: float,
        origin_m: _Point,
        hit: float,
        miss: float,
        limit: float,
    ) -> None: ...
    def insert(
        self,
        x: float,
        y: float,
        heading_rad: float,
        ranges_m: NDArray[np.float32],
        range_m: float,
    ) -> None: ...
    def insert_fan(
        self,
        origin_m: _Point,
        first_rad: float,
        step_rad: float,
        ranges_m: NDArray[np.float32],
        range_m: float,
    ) -> None: ...
    def merge(self, other: OccupancyMap) -> None: ...
    def copy(self) -> OccupancyMap: ...
    def percent(self) -> NDArray[np.int8]: ...
    def log_odds(self) -> NDArray[np.float32]: ...

Voxel: TypeAlias = tuple[int, int, int]
Region: TypeAlias = tuple[Voxel, Voxel]

class Solids:
    """Upright boxes and cylinders that beams hit."""

    def __init__(self, boxes: NDArray[np.float64], cylinders: NDArray[np.float64]) -> None: ...
    def cast(
        self, origin_m: Triple, directions: NDArray[np.float64], threads: int
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]: ...

class LikelihoodField:
    """Values on a grid, row 0 at the bottom, that scans are scored against."""

    def __init__(
        self,
        values: NDArray[np.float32],
        resolution_m: float,
        origin_m: _Point,
        outside: float,
    ) -> None: ...
    @staticmethod
    def around_points(
        points_m: NDArray[np.float64], resolution_m: float, sigma_m: float
    ) -> LikelihoodField: ...
    def scores(
        self, poses: NDArray[np.float64], points_m: NDArray[np.float64]
    ) -> NDArray[np.float64]: ...
    def match(
        self,
        points_m: NDArray[np.float64],
        guess: tuple[float, float, float],
        window: tuple[float, float, float],
        least_score: float,
    ) -> tuple[tuple[float, float, float], float] | None: ...

class Octree:
    def __init__(
        self, resolution_m: float, constants: Constants, memory_limit_bytes: int | None
    ) -> None: ...
    @staticmethod
    def read(contents: bytes, constants: Constants, memory_limit_bytes: int | None) -> Octree: ...
    @property
    def resolution_m(self) -> float: ...
    def insert_scan(
        self,
        origin_m: Triple,
        end_points_m: NDArray[np.float32],
        max_range_m: float | None,
        bounds_m: tuple[Triple, Triple] | None,
        threads: int,
    ) -> None: ...
    def log_odds(
        self, points_m: NDArray[np.float32], levels: int, combine: str
    ) -> NDArray[np.float64]: ...
    def cast_rays(
        self,
        origins_m: NDArray[np.float32],
        directions: NDArray[np.float32],
        max_range_m: float,
        through_unknown: bool,
        threads: int,
    ) -> tuple[NDArray[np.uint8], NDArray[np.float64]]: ...
    def known_voxels(
        self, region: Region | None
    ) -> tuple[NDArray[np.int32], NDArray[np.float64]]: ...
    def leaves(self) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]: ...
    def information_gain(
        self,
        origins_m: NDArray[np.float32],
        directions: NDArray[np.float32],
        max_range_m: float,
        region: Region | None,
        threads: int,
    ) -> NDArray[np.float64]: ...
    def project(
        self, low_z: int, high_z: int, columns: tuple[tuple[int, int], tuple[int, int]] | None
    ) -> tuple[tuple[int, int], NDArray[np.float32]]: ...
    def forget_outside(self, low: Voxel, high: Voxel) -> None: ...
    def set_voxels(self, keys: NDArray[np.int32], log_odds: NDArray[np.float64]) -> None: ...
    def add_channel(self, name: str, constants: Constants) -> None: ...
    def update_channel(
        self, name: str, points_m: NDArray[np.float32], hits: NDArray[np.bool_]
    ) -> None: ...
    def add_to_channel(
        self, name: str, points_m: NDArray[np.float32], log_odds: NDArray[np.float64]
    ) -> None: ...
    def channel_log_odds(self, name: str, points_m: NDArray[np.float32]) -> NDArray[np.float64]: ...
    def memory_bytes(self) -> int: ...
    def node_count(self) -> int: ...
    def brick_counts(self) -> tuple[int, int]: ...
    def unpruned_counts(self) -> tuple[int, int]: ...
    def write_bt(self) -> bytes: ...
    def write_ot(self) -> bytes: ...
