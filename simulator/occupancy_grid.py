"""A building's floor as a grid, read from a ROS map_server YAML file and its image."""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image


class MapError(ValueError):
    """A map that cannot be read: which file, which key, and how to mend it."""


@dataclass(frozen=True, slots=True)
class OccupancyGrid:
    """Cells as in ROS `nav_msgs/OccupancyGrid`, row 0 at the smallest y."""

    cells: NDArray[np.int8]
    """(rows, columns): -1 unknown, 0 free ... 100 occupied"""
    resolution_m: float
    origin_m: tuple[float, float]
    """lower left corner of cell (0, 0) in the map frame"""
    terrain: NDArray[np.uint8] | None = None
    """(rows, columns): index into `terrain_classes`"""
    terrain_classes: tuple[str, ...] = ("default",)

    def walls(self) -> NDArray[np.bool_]:
        """(rows, columns): where no robot can be: occupied or unknown."""
        return np.asarray((self.cells < 0) | (self.cells >= 50))

    def forbidden(self, enters: tuple[str, ...]) -> NDArray[np.bool_]:
        """(rows, columns): terrain that a robot entering only these classes stays out of."""
        if self.terrain is None:
            return np.full(self.cells.shape, "default" not in enters)
        barred = np.array([name not in enters for name in self.terrain_classes])
        return barred.take(self.terrain)


def read_map_server(path: Path) -> OccupancyGrid:
    """Reads the YAML file and the image it names.

    Two keys go beyond map_server's: `terrain_image`, an image of the same size whose grey values
    are indices into the list `terrain_classes`.

    Raises:
        MapError: a file is missing or malformed.
    """
    try:
        keys = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise MapError(f"{path}: cannot be read ({error.strerror}); check the path") from None
    except yaml.YAMLError as error:
        raise MapError(f"{path}: is not YAML: {error}") from None
    if not isinstance(keys, dict):
        raise MapError(f"{path}: must hold keys such as image, resolution and origin")
    try:
        resolution_m = float(keys["resolution"])
        origin = [float(value) for value in keys["origin"]]
        occupied, free = float(keys["occupied_thresh"]), float(keys["free_thresh"])
        image = path.parent / str(keys["image"])
    except KeyError as error:
        raise MapError(f"{path}: the key {error} is missing; add it") from None
    except (TypeError, ValueError) as error:
        raise MapError(f"{path}: a value has the wrong type: {error}") from None
    if len(origin) < 2 or (len(origin) > 2 and origin[2] != 0.0):
        raise MapError(f"{path}: origin must be [x, y, 0]; turned maps are not supported")
    if resolution_m <= 0:
        raise MapError(f"{path}: resolution must be positive, not {resolution_m}")
    shade = _grey(image).astype(np.float64) / 255.0
    occupancy = shade if keys.get("negate") else 1.0 - shade
    cells = np.full(occupancy.shape, -1, dtype=np.int8)
    cells[occupancy > occupied] = 100
    cells[occupancy < free] = 0
    terrain = None
    classes: tuple[str, ...] = ("default",)
    if "terrain_image" in keys:
        terrain = _grey(path.parent / str(keys["terrain_image"]))
        classes = tuple(str(name) for name in keys.get("terrain_classes", ["default"]))
        if terrain.shape != cells.shape or int(terrain.max()) >= len(classes):
            raise MapError(
                f"{path}: terrain_image must be as large as image and hold indices below "
                f"{len(classes)}, the number of terrain_classes"
            )
    return OccupancyGrid(cells, resolution_m, (origin[0], origin[1]), terrain, classes)


def _grey(path: Path) -> NDArray[np.uint8]:
    """(rows, columns), turned upside down: an image's first row is its top."""
    try:
        with Image.open(path) as image:
            return np.ascontiguousarray(np.asarray(image.convert("L"), dtype=np.uint8)[::-1])
    except OSError as error:
        raise MapError(f"{path}: cannot be read as an image: {error}") from None


def packed(cells: NDArray[np.int8] | NDArray[np.uint8]) -> str:
    """Cells row by row from the bottom, zlib and base64."""
    return base64.b64encode(zlib.compress(np.ascontiguousarray(cells).tobytes(), 6)).decode("ascii")
