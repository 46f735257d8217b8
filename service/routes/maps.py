"""Maps: occupancy grids that missions and planning requests use by name."""

import numpy as np
from fastapi import Request

from service.coordination.known_map import OCCUPIED_FROM, grid_map
from service.json_body import described
from service.messages.map_grid import MapMessage
from service.messages.resource import MapPair, MapVersion
from service.resources.map_reading import from_request, oddities
from service.routes.resource_access import summarised
from service.routes.resources import Noun, router
from service.store.resource_store import Content, Stored

MULTIPART = {
    "multipart/form-data": {
        "schema": {
            "type": "object",
            "required": ["yaml", "image"],
            "properties": {
                "yaml": {"type": "string", "format": "binary"},
                "image": {"type": "string", "format": "binary"},
            },
        }
    }
}


async def read(request: Request, body: bytes, _: str | None) -> Content:
    """The map in a body."""
    checked = await from_request(request, body, request.app.state.settings.max_map_cells)
    return checked.content


def show(stored: Stored) -> MapVersion:
    """A version with its cells and what looks odd about it."""
    message = MapMessage.model_validate_json(stored.body)
    grid = grid_map(message, message.width * message.height)
    unknown = int(np.count_nonzero(grid.cells < 0))
    occupied = int(np.count_nonzero(grid.cells >= OCCUPIED_FROM))
    return MapVersion(
        **summarised(stored),
        free_cells=grid.cells.size - unknown - occupied,
        occupied_cells=occupied,
        unknown_cells=unknown,
        diagnostics=oddities(grid),
        map=message,
    )


def _upload() -> dict[str, object]:
    body = described(MapMessage)
    pair = described(MapPair)["requestBody"]["content"]["application/json"]["schema"]
    json = body["requestBody"]["content"]["application/json"]
    json["schema"] = {"anyOf": [json["schema"], pair]}
    body["requestBody"]["content"] |= MULTIPART
    return body


ROUTER = router(Noun("map", "maps", read, show, MapVersion, _upload()))
BODIES = (MapMessage, MapPair)
