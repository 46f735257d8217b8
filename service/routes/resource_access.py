"""Who may see and change a domain or map, and which version a request expects."""

import re
from http import HTTPStatus
from typing import Annotated, Any

import anyio.to_thread
from fastapi import Depends, Header, Request

from service.access import ANY_FLEET, Caller
from service.messages.resource import ResourceKind, ResourceSummary
from service.problem_details import ProblemError, not_found
from service.resources.library import EVERY_FLEET, Library
from service.store.resource_store import ANY_VERSION, NO_VERSION, PreconditionError, Stored

TAG = re.compile(r'^\s*(?:W/)?"([0-9a-f]{1,64})"\s*$')
"""An `ETag` that is a version."""


async def library(request: Request) -> Library:
    """What this service keeps."""
    found: Library = request.app.state.library
    return found


LibraryOf = Annotated[Library, Depends(library)]


def summary(stored: Stored) -> ResourceSummary:
    """A version without its content."""
    return ResourceSummary(**summarised(stored))


def summarised(stored: Stored) -> dict[str, Any]:
    """The members that all kinds share."""
    names = ResourceSummary.model_fields
    return {name: getattr(stored, name) for name in names}


async def expected_version(
    if_match: Annotated[str | None, Header()] = None,
    if_none_match: Annotated[str | None, Header()] = None,
) -> str | None:
    """What `If-Match` and `If-None-Match: *` ask of the current version (RFC 9110, section 13)."""
    if if_match is not None:
        if if_match.strip() == "*":
            return ANY_VERSION
        match = TAG.match(if_match)
        # A tag that no version can have matches none.
        return match.group(1) if match else "unknown"
    if if_none_match is not None and if_none_match.strip() == "*":
        return NO_VERSION
    return None


Expected = Annotated[str | None, Depends(expected_version)]


def may_see(caller: Caller, stored: Stored) -> bool:
    """Whether a resource is the caller's business."""
    return stored.fleet == EVERY_FLEET or caller.reaches(stored.fleet)


async def found_or_404(
    kept: Library, caller: Caller, kind: ResourceKind, name: str, version: str | None = None
) -> Stored:
    """The current version, or the one that begins so.

    Raises:
        ProblemError: 404, or 409 if more than one does.
    """
    found = await anyio.to_thread.run_sync(kept.store.find, kind, name, version)
    if not found or not may_see(caller, found[0]):
        raise not_found(kind, name if version is None else f"{name}@{version}")
    if len(found) > 1:
        raise ProblemError(
            HTTPStatus.CONFLICT, "ambiguous", f"more than one version begins with {version}"
        )
    return found[0]


def owner(caller: Caller, asked: str | None, before: Stored | None) -> str:
    """Whose a resource is, or is to be.

    Raises:
        ProblemError: 403 if the caller may not write it.
    """
    fleet = before.fleet if before is not None else asked
    if fleet is None:
        own = sorted(caller.fleets - {ANY_FLEET})
        fleet = own[0] if ANY_FLEET not in caller.fleets and len(own) == 1 else EVERY_FLEET
    if fleet == EVERY_FLEET and ANY_FLEET not in caller.fleets:
        why = "it is everybody's" if before is not None else "say whose it is with ?fleet=NAME"
        raise ProblemError(
            HTTPStatus.FORBIDDEN, "forbidden", f"the key {caller.name!r} reaches some fleets: {why}"
        )
    if fleet != EVERY_FLEET and not caller.reaches(fleet):
        raise ProblemError(
            HTTPStatus.FORBIDDEN,
            "forbidden",
            "the name is taken" if before is not None else f"this key does not reach {fleet!r}",
        )
    return fleet


def precondition_failed(kind: str, name: str, error: PreconditionError) -> ProblemError:
    """Somebody else has changed it in the meantime."""
    headers = {"ETag": f'"{error.current}"'} if error.current else {}
    return ProblemError(
        HTTPStatus.PRECONDITION_FAILED,
        "precondition-failed",
        f"the {kind} {name!r} was not changed: {error}; get it again, and send the change anew",
        headers=headers,
    )
