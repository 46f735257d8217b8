"""Uploaded maps: the protocol's JSON, or a ROS map_server pair of YAML and image.

The image that a YAML file names is never looked for: it comes in the same request.
"""

import base64
import binascii
import io
import json
import warnings
from collections.abc import AsyncIterator
from dataclasses import dataclass

import numpy as np
from fastapi import Request
from PIL import Image
from pydantic import ValidationError
from starlette.datastructures import UploadFile
from starlette.formparsers import MultiPartException, MultiPartParser

from semantic_attachments.grid_map import GridMap
from semantic_attachments.map_server import MapFileError, map_of, read_header
from service.coordination.known_map import OCCUPIED_FROM, MapError, grid_map
from service.messages.map_grid import MapMessage
from service.messages.resource import MapPair
from service.problem_details import from_validation, invalid
from service.store.resource_store import Content

MOST_YAML_BYTES = 65536


@dataclass(frozen=True)
class CheckedMap:
    """A map that the service can use."""

    content: Content
    grid: GridMap


def from_message(message: MapMessage, max_cells: int) -> CheckedMap:
    """A map in the protocol's encoding.

    Raises:
        ProblemError: 422 with the field that is wrong.
    """
    try:
        grid = grid_map(message, max_cells)
    except MapError as error:
        raise invalid([(f"/{error.field}", str(error))]) from None
    # Written anew, so that equal maps are equal whatever compressed them.
    body = MapMessage.model_validate_json(_json(grid)).model_dump_json()
    return CheckedMap(Content(grid.digest, body), grid)


def from_pair(yaml_text: str, image: bytes, max_cells: int) -> CheckedMap:
    """A map_server pair; the image's first row becomes the top of the map.

    Raises:
        ProblemError: 422 with the part that is wrong.
    """
    try:
        header = read_header(yaml_text, "the YAML file")
    except MapFileError as error:
        raise invalid([("/yaml", str(error))]) from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            grid = map_of(header, io.BytesIO(image), max_cells)
        message = MapMessage.model_validate_json(_json(grid))
    except (Image.DecompressionBombWarning, Image.DecompressionBombError):
        raise invalid([("/image", "has more pixels than any map this server accepts")]) from None
    except ValidationError as error:
        # The frame comes from the YAML file: resolution and origin have limits, too.
        raise invalid([("/yaml", fault["msg"]) for fault in error.errors()]) from None
    except ValueError as error:
        raise invalid([("/image", str(error))]) from None
    except (OSError, SyntaxError) as error:
        # Image decoders raise SyntaxError for broken files.
        raise invalid([("/image", f"cannot be read as an image: {error}")]) from None
    return from_message(message, max_cells)


async def from_request(request: Request, body: bytes, max_cells: int) -> CheckedMap:
    """The map in a request's body, whichever way it is sent.

    Raises:
        ProblemError: 400 or 422, what is wrong with it.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind == "multipart/form-data":
        yaml_text, image = await _parts(request, body)
        return from_pair(yaml_text, image, max_cells)
    try:
        if _is_pair(body):
            pair = MapPair.model_validate_json(body)
            return from_pair(pair.yaml, _unpacked(pair.image), max_cells)
        return from_message(MapMessage.model_validate_json(body), max_cells)
    except ValidationError as error:
        raise from_validation(error) from None


def oddities(grid: GridMap) -> list[str]:
    """What looks odd about a map; none of it keeps it from being used."""
    found = []
    free = int(np.count_nonzero((grid.cells >= 0) & (grid.cells < OCCUPIED_FROM)))
    if free == 0:
        found.append("no cell is free: no robot can be anywhere")
    elif free == grid.cells.size:
        found.append("every cell is free: the map has neither walls nor anything unknown")
    if not np.isin(grid.cells, (-1, 0, 100)).any():
        found.append("no cell is -1, 0 or 100: are these occupancies in percent?")
    if grid.resolution_m > 1.0:
        found.append(f"a cell is {grid.resolution_m:g} m wide: robots need finer maps to turn")
    return found


def _is_pair(body: bytes) -> bool:
    try:
        document = json.loads(body)
    except (ValueError, RecursionError):
        return False  # reading it as a map says what is wrong
    return isinstance(document, dict) and "yaml" in document


def _json(grid: GridMap) -> bytes:
    return json.dumps(grid.to_json()).encode()


def _unpacked(text: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError) as error:
        raise invalid([("/image", f"is not base64: {error}")]) from None


async def _parts(request: Request, body: bytes) -> tuple[str, bytes]:
    async def stream() -> AsyncIterator[bytes]:
        yield body

    parser = MultiPartParser(
        request.headers,
        stream(),  # type: ignore[arg-type]  # it only iterates
        max_files=2,
        max_fields=2,
        max_part_size=MOST_YAML_BYTES,
    )
    try:
        form = await parser.parse()
    except (MultiPartException, KeyError) as error:
        why = getattr(error, "message", f"{error} is missing")
        raise invalid([("", f"the multipart form cannot be read: {why}")]) from None
    try:
        yaml_part, image_part = form.get("yaml"), form.get("image")
        if not isinstance(image_part, UploadFile) or yaml_part is None:
            raise invalid(
                [("", "the form has the files yaml and image: -F yaml=@m.yaml -F image=@m.pgm")]
            )
        image = await image_part.read()
        raw = yaml_part if isinstance(yaml_part, str) else await yaml_part.read(MOST_YAML_BYTES)
    finally:
        await form.close()
    try:
        return raw if isinstance(raw, str) else raw.decode(), image
    except UnicodeDecodeError as error:
        raise invalid([("/yaml", f"is not UTF-8: {error.reason}")]) from None
