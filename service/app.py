"""The application: its parts put together."""

import importlib.metadata
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from anyio import to_thread
from fastapi import FastAPI
from opentelemetry import trace

from domains import catalogue
from service import json_body, problem_details, tracing
from service.access import Gate
from service.coordination.ports import Planners
from service.coordination.registry import Missions
from service.coordination.replanning import LoopParameters
from service.coordination.strategies import all_strategies
from service.draining import Draining
from service.jobs.executors import executor, release
from service.jobs.mission_planning import MissionPlanning
from service.jobs.planning_requests import PlanningRequests
from service.jobs.threads import PlanningThreads
from service.jobs.worker_pool import PoolParameters, WorkerPool
from service.metrics import Metrics
from service.observation import Observation
from service.resources.library import Library
from service.routes import (
    domains,
    editor_checks,
    editors,
    maps,
    mission_changes,
    mission_commands,
    mission_events,
    missions,
    operations,
    plans,
    scans,
)
from service.scan_maps import ScanMapFactory, ScanMaps, installed
from service.settings import Settings
from service.store.engine import connect
from service.store.event_store import EventStore
from service.store.plan_store import PlanStore
from service.store.resource_store import ResourceStore
from service.store.schema import prepare


class MissionPlanners:
    """Where missions are planned: threads, or workers that can be ended by force."""

    def __init__(self, settings: Settings, metrics: Metrics) -> None:
        self.executor: WorkerPool | None = None
        self._threads: PlanningThreads | None = None
        if settings.executor == "threads":
            self._threads = PlanningThreads(settings.planning_workers)
            self.planners: Planners = self._threads
            return
        # A mission has one decision under way at most: its queue is as long as there are missions.
        parameters = PoolParameters(
            settings.planning_workers, settings.max_missions, settings.planning_memory_mb
        )
        self.executor = executor(settings, parameters, metrics.replan_waited)
        self.planners = MissionPlanning(self.executor)

    async def close(self) -> None:
        """Stops all planning."""
        if self.executor is not None:
            await self.executor.close()
        if self._threads is not None:
            self._threads.close()


def create_app(
    settings: Settings | None = None,
    tracer_provider: trace.TracerProvider | None = None,
    scan_maps: ScanMapFactory | None = None,
) -> FastAPI:
    """The coordination service; opens its database when it starts, not before.

    Args:
        tracer_provider: where spans go, if not to the endpoint of the settings.
        scan_maps: makes the 3D maps of missions, if not the installed plug-in.
    """
    settings = settings or Settings()

    provider = tracer_provider
    if provider is None and settings.traces_to is not None:
        provider = tracing.exported_to(settings.traces_to)
    tracer = (provider or trace.NoOpTracerProvider()).get_tracer("marsupial")
    metrics = Metrics(tracer)

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        engine = connect(settings.database_url)
        await to_thread.run_sync(prepare, engine)
        store = EventStore(engine)
        planning = MissionPlanners(settings, metrics)
        pool = executor(
            settings,
            PoolParameters(
                settings.planning_processes, settings.planning_queue, settings.planning_memory_mb
            ),
            metrics.request_waited,
        )
        app.state.store, app.state.executor = store, pool
        app.state.mission_executor = planning.executor
        app.state.planning_requests = PlanningRequests(
            PlanStore(engine), pool, catalogue.ROOT, tracer
        )
        library = Library(ResourceStore(engine))
        await to_thread.run_sync(library.install_built_in)
        app.state.library = library
        app.state.missions = Missions(
            store,
            all_strategies(),
            planning.planners,
            LoopParameters(
                debounce_s=settings.debounce_s,
                idle_replan_s=settings.idle_replan_s,
                give_up_s=settings.give_up_s,
                hopeless_s=settings.hopeless_s,
            ),
            observer=metrics,
            resources=library,
            max_missions=settings.max_missions,
            max_map_cells=settings.max_map_cells,
        )
        app.state.scan_maps = ScanMaps(
            scan_maps or installed(), settings.max_scan_map_mb * 10**6, settings.scan_maps_folder
        )
        app.state.draining.then(app.state.missions.hush)
        app.state.draining.then(app.state.planning_requests.hush)
        await app.state.missions.restore()
        await app.state.planning_requests.restore()
        try:
            yield
        finally:
            await pool.drain(settings.drain_s)
            await app.state.missions.stop()
            await app.state.scan_maps.close()
            await app.state.planning_requests.close()
            await pool.close()
            await planning.close()
            await to_thread.run_sync(release, settings)
            store.close()

    app = FastAPI(
        title="marsupial",
        summary="Coordinates teams of unlike robots by temporal planning",
        version=importlib.metadata.version("marsupial"),
        lifespan=lifespan,
        telemetry=tracing.of_requests(provider),
    )
    app.state.settings = settings
    app.state.metrics = metrics
    app.state.draining = Draining()
    app.state.gate = Gate(settings.api_keys)
    app.add_middleware(Observation, metrics=metrics)
    problem_details.install(app)
    nouns = (missions, mission_changes, plans, domains, maps, editors, editor_checks)
    json_body.install_openapi(app, [body for noun in nouns for body in noun.BODIES])
    for noun in (
        operations,
        missions,
        mission_changes,
        mission_events,
        mission_commands,
        scans,
        plans,
        domains,
        maps,
        editors,
        editor_checks,
    ):
        app.include_router(noun.ROUTER)
    return app
