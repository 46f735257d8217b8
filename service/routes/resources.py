"""Domains and maps as versioned resources: one set of routes for both kinds."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from http import HTTPStatus
from typing import Annotated, Any, TypeAlias

import anyio.to_thread
from fastapi import APIRouter, Depends, Header, Path, Query, Request, Response

from service.access import caller_of, needs
from service.coordination.ports import StoreError
from service.json_body import read_limited
from service.messages.resource import MissionUse, ResourceKind, ResourceSummary
from service.problem_details import ProblemError
from service.resources.library import BUILT_IN
from service.routes.missions import unavailable
from service.routes.resource_access import (
    TAG,
    Expected,
    LibraryOf,
    found_or_404,
    may_see,
    owner,
    precondition_failed,
    summary,
)
from service.store.resource_store import (
    Content,
    InUseError,
    LimitReachedError,
    PreconditionError,
    Stored,
)

NAME = r"^[a-z0-9][a-z0-9_-]{0,63}$"
Name = Annotated[str, Path(pattern=NAME, description="Lower-case letters, digits, - and _.")]
Version = Annotated[str, Path(pattern=r"^[0-9a-f]{8,32}$", description="A version, or its start.")]

Read: TypeAlias = Callable[[Request, bytes, str | None], Awaitable[Content]]
"""Checks a body, given the formulation of the version before."""
Show: TypeAlias = Callable[[Stored], Any]


@dataclass(frozen=True)
class Noun:
    """A kind of resource, as far as its routes differ from the other's."""

    kind: ResourceKind
    plural: str
    read: Read
    show: Show
    model: type[ResourceSummary]
    body: dict[str, Any]
    """`openapi_extra` of the upload."""


def router(noun: Noun) -> APIRouter:
    """The routes of a kind of resource."""
    routes = APIRouter(
        prefix=f"/v1/{noun.plural}", tags=[noun.plural], dependencies=[Depends(needs("edit"))]
    )
    _add_current(routes, noun)
    _add_upload(routes, noun)
    _add_removal(routes, noun)
    _add_versions(routes, noun)
    return routes


def _add_current(routes: APIRouter, noun: Noun) -> None:
    kind = noun.kind

    @routes.get("", summary=f"List {noun.plural}", operation_id=f"list_{noun.plural}")
    async def _(request: Request, kept: LibraryOf) -> list[ResourceSummary]:
        """The current version of each."""
        caller = caller_of(request)
        listed = await anyio.to_thread.run_sync(kept.store.listed, kind)
        return [summary(one) for one in listed if may_see(caller, one)]

    @routes.get(
        "/{name}",
        response_model=noun.model,
        summary=f"Get a {kind}",
        operation_id=f"get_{kind}",
        responses={304: {"description": "The version named in If-None-Match is still current."}},
    )
    async def _(
        request: Request,
        name: Name,
        kept: LibraryOf,
        response: Response,
        if_none_match: Annotated[str | None, Header()] = None,
    ) -> Any:
        """The current version; its `ETag` is the version."""
        stored = await found_or_404(kept, caller_of(request), kind, name)
        response.headers["ETag"] = f'"{stored.version}"'
        match = TAG.match(if_none_match or "")
        if match and match.group(1) == stored.version:
            return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=dict(response.headers))
        return await anyio.to_thread.run_sync(noun.show, stored)


def _add_upload(routes: APIRouter, noun: Noun) -> None:
    kind = noun.kind

    @routes.put(
        "/{name}",
        response_model=noun.model,
        summary=f"Upload a {kind}",
        operation_id=f"put_{kind}",
        openapi_extra=noun.body,
        responses={
            201: {"model": noun.model, "description": "A new version."},
            412: {"description": "Another version is current than If-Match says."},
        },
    )
    async def _(
        request: Request,
        name: Name,
        kept: LibraryOf,
        response: Response,
        *,
        expected: Expected,
        fleet: Annotated[str | None, Query(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.:-]{0,63}$")] = None,
    ) -> Any:
        """Makes the body the current version: 201 if it is new, 200 if it was kept already.

        Earlier versions stay; missions under way keep theirs. With `If-Match: "version"` the
        upload counts only if that version is current, with `If-None-Match: *` only if the name is
        free.
        """
        caller = caller_of(request)
        found = await anyio.to_thread.run_sync(kept.store.find, kind, name)
        before = found[0] if found else None
        whose = owner(caller, fleet, before)
        body = await read_limited(request, request.app.state.settings.max_body_bytes)
        content = await noun.read(request, body, before.formulation if before else None)

        def put() -> bool:
            return kept.store.put(
                kind, name, content, fleet=whose, by=caller.name, expected=expected
            )

        try:
            is_new = await anyio.to_thread.run_sync(put)
        except PreconditionError as error:
            raise precondition_failed(kind, name, error) from None
        except LimitReachedError as error:
            raise ProblemError(HTTPStatus.CONFLICT, "limit-reached", str(error)) from None
        except StoreError as error:
            raise unavailable(error) from None
        stored = await found_or_404(kept, caller, kind, name, content.version)
        response.status_code = HTTPStatus.CREATED if is_new else HTTPStatus.OK
        response.headers["ETag"] = f'"{content.version}"'
        response.headers["Location"] = f"/v1/{noun.plural}/{name}/versions/{content.version}"
        return await anyio.to_thread.run_sync(noun.show, stored)


def _add_removal(routes: APIRouter, noun: Noun) -> None:
    kind = noun.kind

    @routes.delete(
        "/{name}",
        status_code=HTTPStatus.NO_CONTENT,
        summary=f"Forget a {kind}",
        operation_id=f"delete_{kind}",
        responses={412: {"description": "Another version is current than If-Match says."}},
    )
    async def _(request: Request, name: Name, kept: LibraryOf, expected: Expected) -> None:
        """Forgets it with all its versions, if no open mission uses one."""
        caller = caller_of(request)
        stored = await found_or_404(kept, caller, kind, name)
        owner(caller, None, stored)
        if stored.created_by == BUILT_IN:
            raise ProblemError(
                HTTPStatus.CONFLICT, "built-in", f"the {kind} {name!r} comes with the service"
            )
        try:
            await anyio.to_thread.run_sync(kept.store.remove, kind, name, expected)
        except PreconditionError as error:
            raise precondition_failed(kind, name, error) from None
        except InUseError as error:
            raise ProblemError(HTTPStatus.CONFLICT, "in-use", str(error)) from None
        except StoreError as error:
            raise unavailable(error) from None
        await anyio.to_thread.run_sync(kept.install_built_in)


def _add_versions(routes: APIRouter, noun: Noun) -> None:
    kind = noun.kind

    @routes.get(
        "/{name}/versions",
        summary=f"List the versions of a {kind}",
        operation_id=f"list_{kind}_versions",
    )
    async def _(request: Request, name: Name, kept: LibraryOf) -> list[ResourceSummary]:
        """All versions, the latest upload first."""
        await found_or_404(kept, caller_of(request), kind, name)
        versions = await anyio.to_thread.run_sync(kept.store.versions, kind, name)
        return [summary(one) for one in versions]

    @routes.get(
        "/{name}/versions/{version}",
        response_model=noun.model,
        summary=f"Get a version of a {kind}",
        operation_id=f"get_{kind}_version",
    )
    async def _(
        request: Request, name: Name, version: Version, kept: LibraryOf, response: Response
    ) -> Any:
        """A version; it never changes."""
        stored = await found_or_404(kept, caller_of(request), kind, name, version)
        response.headers["ETag"] = f'"{stored.version}"'
        response.headers["Cache-Control"] = "private, max-age=31536000, immutable"
        return await anyio.to_thread.run_sync(noun.show, stored)

    @routes.get(
        "/{name}/missions",
        summary=f"List the missions that use a {kind}",
        operation_id=f"list_{kind}_missions",
    )
    async def _(request: Request, name: Name, kept: LibraryOf) -> list[MissionUse]:
        """Missions that use a version of it, and which, the latest first."""
        caller = caller_of(request)
        await found_or_404(kept, caller, kind, name)
        uses = await anyio.to_thread.run_sync(kept.store.uses, kind, name)
        return [use for fleet, use in uses if caller.reaches(fleet)]
