"""3D maps that the scans of a mission's robots are fused into.

The map itself is a plug-in, found under the entry point `marsupial.scan_maps`: the service knows
this port and the message of a scan, not how space is stored.
"""

import asyncio
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.metadata import entry_points
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float32]
Origin = tuple[float, float, float]

HEADER = struct.Struct("<4sHHddddI")
"""Magic, version, encoding, position of the sensor in the map frame [m], scale [m], beams."""
MAGIC, VERSION, FLOATS, INTEGERS = b"MSCN", 1, 0, 1


class ScanError(ValueError):
    """A scan that cannot be read, or that the map cannot take."""


class ScanMap(Protocol):
    """What a plug-in does; cells are those of the protocol: -1 unknown, 0 free, 100 occupied."""

    def insert(self, origin_m: Origin, points_m: Points, max_range_m: float | None) -> None:
        """Adds beams from a place to end points `(n, 3)`, map frame.

        Raises:
            MemoryError: the map would take more than its limit; it is as it was.
        """

    def to_bytes(self, ending: str) -> bytes:
        """The map as a `.bt` or `.ot` file.

        Raises:
            ValueError: for another ending, or where the format cannot hold the map.
        """

    def passage(
        self, frame: "Frame", floor_m: float, step_m: float, height_m: float
    ) -> NDArray[np.int8]:
        """Where a robot of some height finds its way, `(frame.height, frame.width)`."""

    def band(self, frame: "Frame", low_m: float, high_m: float) -> NDArray[np.int8]:
        """Occupancy in percent of the columns of a height band, -1 unknown."""

    def memory_bytes(self) -> int:
        """What the map holds."""


@dataclass(frozen=True, slots=True)
class Frame:
    """Where cells lie in the map frame."""

    origin_m: tuple[float, float]
    resolution_m: float
    width: int
    height: int


ScanMapFactory = Callable[[float, int, bytes | None], ScanMap]
"""Makes a map from its voxel size [m], its limit [bytes] and, if any, the `.ot` file to go on
with."""


def installed() -> ScanMapFactory | None:
    """The plug-in of this installation."""
    for found in entry_points(group="marsupial.scan_maps"):
        factory: ScanMapFactory = found.load()
        return factory
    return None


def read_scan(body: bytes) -> tuple[Origin, Points]:
    """Sensor position and end points `(n, 3)`, map frame, of a scan message.

    Raises:
        ScanError: what is wrong with it.
    """
    if len(body) < HEADER.size:
        raise ScanError(f"{len(body)} bytes are no scan: the header alone has {HEADER.size}")
    magic, version, encoding, x, y, z, scale, count = HEADER.unpack_from(body)
    if magic != MAGIC or version != VERSION:
        raise ScanError(f"begins with {magic!r}, version {version}: not {MAGIC!r}, {VERSION}")
    if encoding not in (FLOATS, INTEGERS):
        raise ScanError(f"encoding {encoding} is none of {FLOATS} (float32), {INTEGERS} (int16)")
    kind = np.dtype("<f4") if encoding == FLOATS else np.dtype("<i2")
    expected = HEADER.size + 3 * count * kind.itemsize
    if len(body) != expected:
        raise ScanError(f"{count} beams take {expected} bytes; the body has {len(body)}")
    origin = np.array([x, y, z])
    if not (np.abs(origin) < 1e6).all():
        raise ScanError(f"the sensor stands at {origin.tolist()}: not a position of this map")
    beams = np.frombuffer(body, kind, offset=HEADER.size).reshape(-1, 3).astype(np.float64)
    if encoding == INTEGERS:
        if not 0.0 < scale < 10.0:
            raise ScanError(f"a scale of {scale} m is not one between 0 and 10")
        beams *= scale
    beams = beams[np.isfinite(beams).all(axis=1)]
    return (x, y, z), np.asarray(beams + origin, dtype=np.float32)


@dataclass
class MissionScans:
    """The map of one mission and who gave to it."""

    map: ScanMap
    resolution_m: float
    scans: dict[str, int] = field(default_factory=dict)
    """By robot, since the service was started."""
    lock: asyncio.Lock = field(default_factory=asyncio.Lock)
    unsaved: int = 0


class ScanMaps:
    """The 3D maps of all missions.

    Args:
        folder: where maps are kept for a restart; without one they live as long as the service.
    """

    def __init__(
        self, factory: ScanMapFactory | None, limit_bytes: int, folder: Path | None = None
    ) -> None:
        self.factory = factory
        self._limit_bytes = limit_bytes
        self._folder = folder
        self._missions: dict[str, MissionScans] = {}
        self._opening = asyncio.Lock()

    async def find(self, mission: str) -> MissionScans | None:
        """A mission's map, if any scan came in, also before a restart."""
        async with self._opening:
            return self._missions.get(mission) or await asyncio.to_thread(self._kept, mission)

    async def insert(
        self,
        mission: str,
        robot: str,
        scan: tuple[Origin, Points],
        resolution_m: float,
        max_range_m: float | None,
    ) -> MissionScans:
        """Fuses a scan; the first one of a mission decides on the voxel size.

        Raises:
            ScanError: the mission's map has another voxel size.
            MemoryError: the map is full.
        """
        if self.factory is None:
            raise ScanError("no 3D map is installed")
        found = await self.find(mission)
        async with self._opening:
            if found is None and (found := self._missions.get(mission)) is None:
                made = self.factory(resolution_m, self._limit_bytes, None)
                found = self._missions[mission] = MissionScans(made, resolution_m)
        if found.resolution_m != resolution_m:
            raise ScanError(
                f"the mission's map has voxels of {found.resolution_m} m, not {resolution_m} m"
            )
        async with found.lock:
            await asyncio.to_thread(found.map.insert, *scan, max_range_m)
            found.scans[robot] = found.scans.get(robot, 0) + 1
            found.unsaved += 1
            if found.unsaved >= 20:
                await asyncio.to_thread(self._keep, mission, found)
        return found

    async def close(self) -> None:
        """Keeps what was not kept yet."""
        for mission, found in self._missions.items():
            async with found.lock:
                await asyncio.to_thread(self._keep, mission, found)

    def _keep(self, mission: str, found: MissionScans) -> None:
        if self._folder is None or not found.unsaved:
            return
        self._folder.mkdir(parents=True, exist_ok=True)
        path = self._path(mission)
        partial = path.with_suffix(".partial")
        partial.write_bytes(found.map.to_bytes(".ot"))
        partial.replace(path)  # a service killed meanwhile leaves the map before
        found.unsaved = 0

    def _kept(self, mission: str) -> MissionScans | None:
        if self._folder is None or self.factory is None or not self._path(mission).is_file():
            return None
        contents = self._path(mission).read_bytes()
        resolution_m = next(
            float(line.split()[1]) for line in contents.splitlines()[:10] if line[:4] == b"res "
        )
        made = self.factory(resolution_m, self._limit_bytes, contents)
        found = self._missions[mission] = MissionScans(made, resolution_m)
        return found

    def _path(self, mission: str) -> Path:
        folder = self._folder or Path()
        return folder / f"{mission}.ot"
