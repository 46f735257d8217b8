"""All missions of a service: created, found, restored after a crash."""

import asyncio
import hashlib
import uuid
from collections.abc import Mapping

from service.coordination.admission import mission_faults
from service.coordination.coordinator import Coordinator
from service.coordination.events import Event, MissionCreated
from service.coordination.history import created, rebuilt
from service.coordination.known_map import robot_models
from service.coordination.mission import Mission
from service.coordination.ports import (
    Fault,
    KeyReusedError,
    Observer,
    Planners,
    Resources,
    UnresolvedError,
)
from service.coordination.replanning import LoopParameters
from service.coordination.strategy import Strategy
from service.messages.mission import MissionRequest
from service.store.event_store import EventStore


class MissionRefusedError(Exception):
    """A mission that cannot be accepted."""

    def __init__(self, faults: list[Fault]) -> None:
        super().__init__(faults[0][1])
        self.faults = faults


class FullError(Exception):
    """More missions are open than the operator allows."""


class Missions:
    """The missions of one service; those that are over live in the log alone."""

    def __init__(
        self,
        store: EventStore,
        strategies: Mapping[str, Strategy],
        planners: Planners,
        parameters: LoopParameters,
        *,
        observer: Observer,
        resources: Resources,
        max_missions: int,
        max_map_cells: int,
    ) -> None:
        self._store = store
        self._strategies = strategies
        self._planners = planners
        self._parameters = parameters
        self._observer = observer
        self._resources = resources
        self._max_missions = max_missions
        self._max_map_cells = max_map_cells
        self._open: dict[str, Coordinator] = {}
        self._creating = asyncio.Lock()

    async def restore(self) -> int:
        """Takes up all missions that are not over; returns their number."""
        for mission_id in await asyncio.to_thread(self._store.open_missions):
            mission = await asyncio.to_thread(rebuilt, self._store.events(mission_id))
            coordinator = self._coordinator(mission)
            self._open[mission_id] = coordinator
            if mission.status != "queued":
                coordinator.replan("the service was started again")
        return len(self._open)

    async def create(
        self, request: MissionRequest, idempotency_key: str | None = None
    ) -> Coordinator:
        """A new mission, stored before it is returned.

        Args:
            request: what it names is looked up once; the mission keeps these versions.
            idempotency_key: the same key with the same request gives the same mission.

        Raises:
            MissionRefusedError: with everything that is wrong with it.
            FullError: too many missions are open.
            KeyReusedError: the key was used for another mission.
        """
        async with self._creating:
            return await self._create(request, idempotency_key)

    async def _create(self, request: MissionRequest, idempotency_key: str | None) -> Coordinator:
        digest = hashlib.sha256(request.model_dump_json().encode()).hexdigest()
        if idempotency_key is not None:
            before = await asyncio.to_thread(self._store.created_under, idempotency_key)
            if before is not None:
                mission_id, body_digest = before
                found = await self.find(mission_id) if body_digest == digest else None
                if found is None:
                    raise KeyReusedError("this Idempotency-Key was used for another mission")
                return found
        self._forget_closed()
        if len(self._open) >= self._max_missions:
            raise FullError(f"{len(self._open)} missions are open, which is all that is allowed")
        try:
            resolved = await self._resources.mission(request)
        except UnresolvedError as error:
            raise MissionRefusedError(error.faults) from None
        faults = mission_faults(resolved.request, self._strategies, self._max_map_cells)
        if faults:
            raise MissionRefusedError(faults)
        event = MissionCreated(
            id=uuid.uuid4().hex,
            request=resolved.request,
            domain_text=resolved.domain_text,
            resources=list(resolved.used),
            idempotency_key=idempotency_key,
            body_digest=digest,
        )
        await asyncio.shield(asyncio.ensure_future(self._store.append(event.id, 0, [event])))
        coordinator = self._coordinator(created(event))
        self._open[event.id] = coordinator
        return coordinator

    async def find(self, mission_id: str) -> Coordinator | None:
        """A mission, open or over; None if there never was one."""
        if (coordinator := self._open.get(mission_id)) is not None:
            return coordinator
        events = await asyncio.to_thread(lambda: list(self._store.events(mission_id)))
        return self._coordinator(rebuilt(events)) if events else None

    async def listed(self, limit: int) -> list[Coordinator]:
        """The latest missions, open and over."""
        ids = await asyncio.to_thread(self._store.listed, limit)
        return [found for mission_id in ids if (found := await self.find(mission_id)) is not None]

    @property
    def open_count(self) -> int:
        """Missions that are not over."""
        return sum(not found.mission.is_over for found in self._open.values())

    def events(self, mission_id: str, first_number: int, limit: int) -> list[tuple[int, Event]]:
        """A mission's events with their numbers, from `first_number`; reads the log."""
        return list(self._store.numbered(mission_id, first_number, limit))

    def hush(self) -> None:
        """Sends all listeners away: the service is to stop."""
        for coordinator in self._open.values():
            coordinator.hush()

    async def stop(self) -> None:
        """Stops all loops; every mission goes on when the service is started again."""
        for coordinator in self._open.values():
            await coordinator.stop()

    def _forget_closed(self) -> None:
        for mission_id in [key for key, value in self._open.items() if value.mission.is_over]:
            del self._open[mission_id]
            self._planners.forget(mission_id)

    def _coordinator(self, mission: Mission) -> Coordinator:
        request = mission.request
        return Coordinator(
            mission,
            models=robot_models(request),
            strategy=self._strategies[request.strategy],
            log=self._store,
            planners=self._planners,
            parameters=self._parameters,
            observer=self._observer,
        )
