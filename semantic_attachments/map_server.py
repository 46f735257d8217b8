"""Maps on disk in the format of ROS map_server: a YAML file that names an image.

Source: https://wiki.ros.org/map_server, "Map format" and "Value interpretation".
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from semantic_attachments.grid_map import GridMap

_MODES = ("trinary", "scale", "raw")


class MapFileError(ValueError):
    """A map file that cannot be read: says which, what is wrong and how to mend it."""


@dataclass(frozen=True, slots=True)
class Interpretation:
    """How an image's brightness reads as occupancy."""

    negate: bool = False
    """Whether white is occupied instead of black."""
    occupied_thresh: float = 0.65
    """Above this share a cell is occupied."""
    free_thresh: float = 0.196
    """Below this share a cell is free."""
    mode: str = "trinary"
    """`trinary`, `scale` (in between become 1 ... 99) or `raw` (the value is the occupancy)."""


def read_map(path: str | Path) -> GridMap:
    """Reads a map_server YAML file and its image; the image's first row becomes the top row.

    Raises:
        MapFileError: if a file is missing or malformed, or the map's frame is turned.
    """
    path = Path(path)
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise MapFileError(f"{path}: there is no such map file") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise MapFileError(f"{path}: this is not YAML: {error}") from None
    if not isinstance(document, dict):
        raise MapFileError(f"{path}: a map file has the fields image, resolution and origin")
    image_path = path.parent / str(_field(document, "image", path))
    origin = _field(document, "origin", path)
    try:
        resolution_m = float(_field(document, "resolution", path))
        x, y, yaw = (float(value) for value in [*origin, 0.0][:3])
        interpretation = Interpretation(
            negate=bool(int(document.get("negate", 0))),
            occupied_thresh=float(document.get("occupied_thresh", 0.65)),
            free_thresh=float(document.get("free_thresh", 0.196)),
            mode=str(document.get("mode", "trinary")),
        )
    except (TypeError, ValueError) as error:
        raise MapFileError(f"{path}: a field is not a number: {error}") from None
    if yaw != 0.0:
        raise MapFileError(f"{path}: origin has a yaw of {yaw}; turn the image instead (yaw 0)")
    if interpretation.mode not in _MODES:
        raise MapFileError(f"{path}: mode {interpretation.mode!r} is none of {', '.join(_MODES)}")
    try:
        with Image.open(image_path) as image:
            cells = occupancy(_channels(image), interpretation)
    except FileNotFoundError:
        raise MapFileError(f"{path}: its image {image_path} does not exist") from None
    except (UnidentifiedImageError, OSError) as error:
        raise MapFileError(f"{path}: its image {image_path} cannot be read: {error}") from None
    try:
        return GridMap(cells=cells[::-1], resolution_m=resolution_m, origin_m=(x, y))
    except ValueError as error:
        raise MapFileError(f"{path}: {error}") from None


def occupancy(pixels: NDArray[np.uint8], interpretation: Interpretation) -> NDArray[np.int8]:
    """(height, width, channels) brightness, the last channel being alpha if there are 2 or 4."""
    has_alpha = pixels.shape[2] in (2, 4)
    colours = pixels[:, :, :-1] if has_alpha else pixels
    brightness = colours.mean(axis=2)
    if interpretation.mode == "raw":
        raw = np.where(brightness <= 100, np.rint(brightness), -1)
        return raw.astype(np.int8)
    occupied_share = (brightness if interpretation.negate else 255.0 - brightness) / 255.0
    cells = np.full(brightness.shape, -1, dtype=np.int8)
    if interpretation.mode == "scale":
        between = (occupied_share - interpretation.free_thresh) / (
            interpretation.occupied_thresh - interpretation.free_thresh
        )
        cells = np.clip(np.rint(99 * between), 1, 99).astype(np.int8)
        if has_alpha:
            cells[pixels[:, :, -1] < 255] = -1
    known = cells != -1 if interpretation.mode == "scale" else np.ones(cells.shape, dtype=bool)
    cells[known & (occupied_share > interpretation.occupied_thresh)] = 100
    cells[known & (occupied_share < interpretation.free_thresh)] = 0
    return cells


def _channels(image: Image.Image) -> NDArray[np.uint8]:
    if image.mode not in ("L", "LA", "RGB", "RGBA"):
        wanted = "RGBA" if image.mode == "P" and "transparency" in image.info else "RGB"
        image = image.convert("L" if image.mode in ("1", "I", "I;16", "F") else wanted)
    pixels = np.asarray(image, dtype=np.uint8)
    return pixels[:, :, None] if pixels.ndim == 2 else pixels


def _field(document: dict[str, Any], name: str, path: Path) -> Any:
    if document.get(name) is None:
        raise MapFileError(f"{path}: the field {name} is missing")
    return document[name]
