"""Maps on disk in the format of ROS map_server: a YAML file that names an image.

Source: https://wiki.ros.org/map_server, "Map format" and "Value interpretation".
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from semantic_attachments.grid_map import GridMap

_MODES = ("trinary", "scale", "raw")
_FORMATS = ("PPM", "PNG", "BMP", "TIFF", "JPEG", "GIF")
"""Image formats of maps in the wild; PPM includes PGM and PBM."""


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
        header = read_header(path.read_text(encoding="utf-8"), str(path))
    except FileNotFoundError:
        raise MapFileError(f"{path}: there is no such map file") from None
    except UnicodeDecodeError as error:
        raise MapFileError(f"{path}: this is not YAML: {error}") from None
    image_path = path.parent / header.image
    try:
        return map_of(header, image_path)
    except FileNotFoundError:
        raise MapFileError(f"{path}: its image {image_path} does not exist") from None
    except (UnidentifiedImageError, OSError) as error:
        raise MapFileError(f"{path}: its image {image_path} cannot be read: {error}") from None
    except ValueError as error:
        raise MapFileError(f"{path}: {error}") from None


@dataclass(frozen=True, slots=True)
class Header:
    """What the YAML file says."""

    image: str
    """Path of the image, relative to the YAML file."""
    resolution_m: float
    origin_m: tuple[float, float]
    """Lower left corner of the image in the map frame."""
    interpretation: Interpretation


def read_header(text: str, name: str) -> Header:
    """Reads the text of a map_server YAML file; `name` is shown in errors.

    Raises:
        MapFileError: if it is malformed, or the map's frame is turned.
    """
    try:
        document = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise MapFileError(f"{name}: this is not YAML: {error}") from None
    if not isinstance(document, dict):
        raise MapFileError(f"{name}: a map file has the fields image, resolution and origin")
    image = str(_field(document, "image", name))
    origin = _field(document, "origin", name)
    try:
        resolution_m = float(_field(document, "resolution", name))
        x, y, yaw = (float(value) for value in [*origin, 0.0][:3])
        interpretation = Interpretation(
            negate=bool(int(document.get("negate", 0))),
            occupied_thresh=float(document.get("occupied_thresh", 0.65)),
            free_thresh=float(document.get("free_thresh", 0.196)),
            mode=str(document.get("mode", "trinary")),
        )
    except (TypeError, ValueError) as error:
        raise MapFileError(f"{name}: a field is not a number: {error}") from None
    if yaw != 0.0:
        raise MapFileError(f"{name}: origin has a yaw of {yaw}; turn the image instead (yaw 0)")
    if interpretation.mode not in _MODES:
        raise MapFileError(f"{name}: mode {interpretation.mode!r} is none of {', '.join(_MODES)}")
    return Header(image, resolution_m, (x, y), interpretation)


def map_of(header: Header, image: Path | BinaryIO, most_cells: int | None = None) -> GridMap:
    """The map that an image shows, be it a file or an open stream.

    Args:
        most_cells: larger images are refused before they are decoded.

    Raises:
        OSError: if the image cannot be read.
        ValueError: if it is too large, or no map.
    """
    with Image.open(image, formats=_FORMATS) as opened:
        width, height = opened.size
        if most_cells is not None and width * height > most_cells:
            raise ValueError(f"the image has {width} x {height} pixels; {most_cells} are accepted")
        cells = occupancy(_channels(opened), header.interpretation)
    return GridMap(cells=cells[::-1], resolution_m=header.resolution_m, origin_m=header.origin_m)


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


def _field(document: dict[str, Any], name: str, where: str) -> Any:
    if document.get(name) is None:
        raise MapFileError(f"{where}: the field {name} is missing")
    return document[name]
