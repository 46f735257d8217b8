"""Planning requests without a mission."""

import hashlib
from collections.abc import AsyncIterator
from http import HTTPStatus
from typing import Annotated

import anyio.to_thread
from fastapi import APIRouter, Depends, Request, Response
from fastapi.sse import EventSourceResponse, ServerSentEvent

import planner
from service.access import ANY_FLEET, caller_of, needs
from service.coordination.known_map import MapError, read_cells, read_terrain
from service.coordination.ports import KeyReusedError, StoreError, UnresolvedError
from service.jobs.executor import QueueFullError
from service.jobs.planning_requests import Following, PlanningRequests, result
from service.json_body import described, json_body
from service.messages.planning import PlanRequest, PlanResult, PlanSubmission
from service.problem_details import Diagnostic, ProblemError, invalid, not_found
from service.resources.library import Library
from service.routes.mission_events import first_wanted
from service.routes.missions import IdempotencyKey, key_reused, unavailable, wait_s
from service.settings import Settings

ROUTER = APIRouter(prefix="/v1/plans", tags=["plans"], dependencies=[Depends(needs("operate"))])
BODIES = (PlanSubmission,)


async def requests(request: Request) -> PlanningRequests:
    """The planning requests of this service."""
    found: PlanningRequests = request.app.state.planning_requests
    return found


Requests = Annotated[PlanningRequests, Depends(requests)]


async def owned(request: Request, plan_id: str, all_requests: PlanningRequests) -> Following | None:
    """A request that the caller handed in; keys for all fleets see everybody's."""
    found, caller = await all_requests.find(plan_id), caller_of(request)
    if found is None or not (found.client == caller.name or ANY_FLEET in caller.fleets):
        return None
    return found


async def following(request: Request, plan_id: str, all_requests: Requests) -> Following:
    """The request a path names."""
    found = await owned(request, plan_id, all_requests)
    if found is None:
        raise not_found("planning request", plan_id)
    return found


FollowingOf = Annotated[Following, Depends(following)]


def checked(body: PlanRequest, settings: Settings) -> None:
    """Reads domain and problem; every finding has its file, line and column.

    Raises:
        ProblemError: 422 with all findings.
    """
    for where, text in (("/domain_text", body.domain_text), ("/problem", body.problem)):
        if text is not None and len(text) > settings.max_pddl_bytes:
            limit = settings.max_pddl_bytes
            raise invalid([(where, f"is longer than the {limit} bytes this server accepts")])
    try:
        domain = planner.read_domain((body.domain_text or "").encode())
    except planner.PddlError as error:
        raise pddl_problem("/domain_text", error) from None
    try:
        planner.read_problem(domain, body.problem.encode())
    except planner.PddlError as error:
        raise pddl_problem("/problem", error) from None
    if body.map is not None:
        try:
            read_cells(body.map, settings.max_map_cells)
            read_terrain(body.map)
        except MapError as error:
            raise invalid([(f"/map/{error.field}", str(error))]) from None
    elif domain.modules:
        names = ", ".join(module.name for module in domain.modules)
        raise invalid([("/map", f"the domain calls attachments ({names}), which need a map")])


def pddl_problem(where: str, error: planner.PddlError) -> ProblemError:
    """A text with faults, as a problem that shows each with line and column."""
    found = [one for one in error.diagnostics if one.severity == "error"]
    problem = invalid([(where, f"{d.line}:{d.column}: {d.message}") for d in found])
    problem.diagnostics = [
        Diagnostic(
            location=where,
            line=d.line,
            column=d.column,
            end_line=d.end_line,
            end_column=d.end_column,
            severity=d.severity,
            code=d.code,
            message=d.message,
            remedy=d.remedy,
            rendered=d.rendered,
        )
        for d in error.diagnostics
    ]
    return problem


async def prepared(request: Request, body: PlanSubmission) -> PlanRequest:
    """A request with what it names, read and checked.

    Raises:
        ProblemError: 422 with all findings.
    """
    kept: Library = request.app.state.library
    try:
        work = await kept.planning(body, caller_of(request).reaches)
    except UnresolvedError as error:
        raise invalid(error.faults) from None
    await anyio.to_thread.run_sync(checked, work, request.app.state.settings)
    return work


@ROUTER.post(
    "",
    status_code=HTTPStatus.ACCEPTED,
    openapi_extra=described(PlanSubmission),
    responses={200: {"model": PlanResult, "description": "It ended while the sender waited."}},
)
async def submit(
    request: Request,
    body: Annotated[PlanSubmission, Depends(json_body(PlanSubmission))],
    all_requests: Requests,
    wait: Annotated[float, Depends(wait_s)],
    response: Response,
    *,
    idempotency_key: IdempotencyKey = None,
) -> PlanResult:
    """Accepts a problem to solve: 202 and where to look, or the result within `Prefer: wait=N`.

    Sent again with the same `Idempotency-Key`, it gives the request that there is.
    """
    caller = caller_of(request)
    digest = hashlib.sha256(body.model_dump_json().encode()).hexdigest()
    accepted = None
    if idempotency_key is not None:
        try:
            accepted = await all_requests.repeated(caller.name, idempotency_key, digest)
        except KeyReusedError as error:
            raise key_reused(error) from None
    if accepted is None:
        work = await prepared(request, body)
        try:
            accepted = await all_requests.submit(work, caller.name, idempotency_key, digest)
        except QueueFullError as error:
            raise ProblemError(
                HTTPStatus.TOO_MANY_REQUESTS,
                "queue-full",
                str(error),
                headers={"Retry-After": "5"},
            ) from None
        except StoreError as error:
            raise unavailable(error) from None
    response.headers["Location"] = f"/v1/plans/{accepted.id}"
    if wait > 0.0:
        await all_requests.wait(accepted, wait)
    if accepted.is_over:
        response.status_code = HTTPStatus.OK
    else:
        response.headers["Retry-After"] = "1"
    return result(accepted)


@ROUTER.get("/{plan_id}")
async def get_plan(found: FollowingOf) -> PlanResult:
    """A planning request and what has come of it so far."""
    return result(found)


@ROUTER.get("/{plan_id}/events", response_class=EventSourceResponse)
async def plan_events(
    found: FollowingOf,
    all_requests: Requests,
    wanted: Annotated[int, Depends(first_wanted)],
) -> AsyncIterator[ServerSentEvent]:
    """Improving plans as they are found, then how it ended."""
    async for number, told in all_requests.follow(found, wanted):
        yield ServerSentEvent(id=str(number), event=told["kind"], data=told)


@ROUTER.delete("/{plan_id}")
async def cancel(found: FollowingOf, all_requests: Requests) -> PlanResult:
    """Stops a request and frees its worker; the best plan so far stays."""
    await all_requests.cancel(found)
    return result(found)
