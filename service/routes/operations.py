"""For those who run the service."""

from http import HTTPStatus

import anyio.to_thread
from fastapi import APIRouter, Request, Response

from service import metrics
from service.access import needs
from service.coordination.registry import Missions
from service.jobs.executor import Executor
from service.problem_details import ProblemError
from service.store.event_store import EventStore

ROUTER = APIRouter(tags=["operations"])


@ROUTER.get("/healthz")
async def healthz() -> dict[str, str]:
    """The process runs and its event loop turns."""
    return {"status": "ok"}


@ROUTER.get("/readyz")
async def readyz(request: Request) -> dict[str, str]:
    """The service can take work: its database answers and it is not shutting down."""
    if request.app.state.draining.begun:
        raise ProblemError(
            HTTPStatus.SERVICE_UNAVAILABLE, "not-ready", "the service is shutting down"
        )
    store: EventStore = request.app.state.store
    if not await anyio.to_thread.run_sync(store.is_writable):
        raise ProblemError(
            HTTPStatus.SERVICE_UNAVAILABLE, "not-ready", "the database does not answer"
        )
    return {"status": "ready"}


@ROUTER.get("/metrics")
async def exposition(request: Request) -> Response:
    """Measurements in the format of Prometheus."""
    await needs("operate")(request)
    state = request.app.state
    measured: metrics.Metrics = state.metrics
    missions: Missions = state.missions
    executor: Executor = state.executor
    capacity = executor.capacity()
    measured.missions.set(missions.open_count)
    measured.plans_queued.set(capacity.queued)
    measured.plans_running.set(capacity.running)
    measured.worker_restarts.labels("request").set(capacity.restarts)
    mission_executor: Executor | None = state.mission_executor
    if mission_executor is not None:
        capacity = mission_executor.capacity()
        measured.replans_queued.set(capacity.queued)
        measured.replans_running.set(capacity.running)
        measured.worker_restarts.labels("replan").set(capacity.restarts)
    return Response(measured.exposition(), media_type=metrics.CONTENT_TYPE)
