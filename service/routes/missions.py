"""Missions over HTTP; docs/fleet-protocol.md tells what the messages mean."""

import re
from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Depends, Header, Query, Request, Response

from service.access import caller_of, needs
from service.coordination.coordinator import Coordinator, OverError, ReportRefusedError, summary
from service.coordination.ports import KeyReusedError, StoreError
from service.coordination.registry import FullError, MissionRefusedError, Missions
from service.coordination.views import known_map, mission_detail, plan_in_force
from service.json_body import described, json_body
from service.messages.mission import MissionRequest
from service.messages.plan import KnownMap, MissionDetail, PlanInForce
from service.messages.report import MissionSummary, Report, ReportAnswer
from service.problem_details import ProblemError, invalid, not_found
from service.settings import Settings

ROUTER = APIRouter(
    prefix="/v1/missions", tags=["missions"], dependencies=[Depends(needs("operate"))]
)
BODIES = (MissionRequest, Report)
IdempotencyKey = Annotated[str | None, Header(min_length=1, max_length=200)]
_WAIT = re.compile(r"(?:^|[,;\s])wait\s*=\s*\"?(\d{1,6})\"?(?=$|[,;\s])", re.IGNORECASE)


async def missions(request: Request) -> Missions:
    """The missions of this service."""
    found: Missions = request.app.state.missions
    return found


async def wait_s(request: Request, prefer: Annotated[str | None, Header()] = None) -> float:
    """`Prefer: wait=N` (RFC 7240) in seconds, within the operator's limit; 0 without."""
    settings: Settings = request.app.state.settings
    match = _WAIT.search(prefer or "")
    return min(float(match.group(1)), settings.max_wait_s) if match else 0.0


async def coordinator(
    request: Request, mission_id: str, all_missions: Annotated[Missions, Depends(missions)]
) -> Coordinator:
    """The mission a path names, if it is the caller's business."""
    found = await all_missions.find(mission_id)
    if found is None or not caller_of(request).reaches(found.mission.request.fleet):
        raise not_found("mission", mission_id)
    return found


CoordinatorOf = Annotated[Coordinator, Depends(coordinator)]


def unavailable(error: StoreError) -> ProblemError:
    """The log refused; the sender should come again."""
    return ProblemError(
        HTTPStatus.SERVICE_UNAVAILABLE,
        "storage-unavailable",
        f"nothing was stored, please send it again: {error}",
        headers={"Retry-After": "1"},
    )


def key_reused(error: KeyReusedError) -> ProblemError:
    """The key belongs to another request."""
    return ProblemError(HTTPStatus.UNPROCESSABLE_ENTITY, "idempotency-key-reused", str(error))


def over(error: OverError) -> ProblemError:
    """The mission has ended; nothing can be changed any more."""
    return ProblemError(HTTPStatus.CONFLICT, "mission-over", str(error))


@ROUTER.get("")
async def list_missions(
    request: Request,
    all_missions: Annotated[Missions, Depends(missions)],
    limit: Annotated[int, Query(ge=1, le=1000)] = 100,
) -> list[MissionSummary]:
    """The latest missions, open and over."""
    caller = caller_of(request)
    return [
        summary(found.mission)
        for found in await all_missions.listed(limit)
        if caller.reaches(found.mission.request.fleet)
    ]


@ROUTER.post("", status_code=HTTPStatus.CREATED, openapi_extra=described(MissionRequest))
async def create_mission(
    request: Request,
    body: Annotated[MissionRequest, Depends(json_body(MissionRequest))],
    all_missions: Annotated[Missions, Depends(missions)],
    response: Response,
    idempotency_key: IdempotencyKey = None,
) -> MissionDetail:
    """Accepts a mission; it begins with the fleet's first report.

    Sent again with the same `Idempotency-Key`, it gives the mission that there is.
    """
    if not caller_of(request).reaches(body.fleet):
        raise ProblemError(
            HTTPStatus.FORBIDDEN, "forbidden", f"this key does not reach the fleet {body.fleet!r}"
        )
    try:
        created = await all_missions.create(body, idempotency_key)
    except KeyReusedError as error:
        raise key_reused(error) from None
    except MissionRefusedError as error:
        raise invalid(error.faults) from None
    except FullError as error:
        raise ProblemError(
            HTTPStatus.TOO_MANY_REQUESTS, "full", str(error), headers={"Retry-After": "30"}
        ) from None
    except StoreError as error:
        raise unavailable(error) from None
    response.headers["Location"] = f"/v1/missions/{created.mission.id}"
    return mission_detail(created.mission)


@ROUTER.post("/{mission_id}/reports", response_model=ReportAnswer, openapi_extra=described(Report))
async def report(
    found: CoordinatorOf,
    body: Annotated[Report, Depends(json_body(Report))],
    wait: Annotated[float, Depends(wait_s)],
) -> Response:
    """Takes in what the fleet saw and did; answers with every robot's current command.

    With `Prefer: wait=N` the answer waits up to N seconds for the replan that it gives cause for.
    """
    try:
        answer = await found.report(body, wait)
    except ReportRefusedError as error:
        raise invalid(error.faults) from None
    except StoreError as error:
        raise unavailable(error) from None
    # The most frequent answer by far: it is what the model says and need not be checked again.
    return Response(answer.model_dump_json(), media_type="application/json")


@ROUTER.get("/{mission_id}")
async def get_mission(found: CoordinatorOf) -> MissionDetail:
    """The mission: status, robots, targets, blockades, decisions with their reasons."""
    return mission_detail(found.mission)


@ROUTER.delete("/{mission_id}")
async def cancel_mission(found: CoordinatorOf) -> MissionDetail:
    """Cancels the mission: its robots have no commands any more and stop."""
    try:
        await found.cancel("canceled by request")
    except OverError as error:
        raise over(error) from None
    except StoreError as error:
        raise unavailable(error) from None
    return mission_detail(found.mission)


@ROUTER.get("/{mission_id}/plan")
async def get_plan(found: CoordinatorOf) -> PlanInForce:
    """The plan in force."""
    return plan_in_force(found.mission)


@ROUTER.get("/{mission_id}/map")
async def get_map(found: CoordinatorOf) -> KnownMap:
    """The known map with the blockades that are not cleared drawn in."""
    return known_map(found.mission)
