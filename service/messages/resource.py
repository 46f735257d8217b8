"""Domains and maps kept by the service: named, versioned by their content, never overwritten."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from service.messages.base import Identifier, Message
from service.messages.map_grid import MapMessage
from service.problem_details import Diagnostic

ResourceName = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_-]{0,63}$")]
"""A name that is safe in an address, a file system and a log."""

Reference = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_-]{0,63}(@[0-9a-f]{8,32})?$")]
"""`name` means the version that is current now, `name@version` that one; 8 digits are enough."""

MapOrReference = Annotated[
    Annotated[MapMessage, Tag("(map)")] | Annotated[Reference, Tag("(name)")],
    Discriminator(lambda given: "(name)" if isinstance(given, str) else "(map)"),
]
"""A map, or the name of one; tags in brackets are left out of JSON pointers."""

ResourceKind = Literal["domain", "map"]


class DomainUpload(Message):
    """`PUT /v1/domains/{name}`."""

    text: Annotated[str, Field(min_length=1)]
    """PDDL."""
    formulation: Identifier | None = None
    """The built-in domain whose way of posing problems and reading plans missions shall use with
    it; without one the domain is for planning requests only."""


class MapPair(Message):
    """`PUT /v1/maps/{name}` with a ROS map_server pair; multipart needs no base64."""

    yaml: Annotated[str, Field(max_length=65536)]
    """Text of the YAML file; the file that it names is never looked for."""
    image: str
    """The image (PGM, PNG, BMP, ...) in base64."""


class ResourceSummary(Message):
    """A domain or map and its current version."""

    name: str
    version: str
    """Hash of the content."""
    fleet: str
    """Whose it is; `*` is everybody's."""
    created_at: datetime
    created_by: str
    size_bytes: int
    """Length of the stored content."""


class DomainVersion(ResourceSummary):
    """A version of a domain."""

    formulation: str | None
    actions: list[str]
    modules: list[str]
    """Attachments that it calls."""
    requirements: list[str]
    diagnostics: list[Diagnostic]
    """Warnings; a text with errors is not accepted."""
    text: str


class MapVersion(ResourceSummary):
    """A version of a map."""

    free_cells: int
    occupied_cells: int
    unknown_cells: int
    diagnostics: list[str]
    """What looks odd about it."""
    map: MapMessage


class MissionUse(Message):
    """A mission that uses a version of a resource."""

    mission: str
    name: str
    version: str
    is_over: bool


class UsedResource(Message):
    """A version that a mission uses, as long as it lasts."""

    kind: ResourceKind
    name: str
    version: str
