"""All missions of a service: created, found, restored after a crash."""

import asyncio
import uuid
from collections.abc import Mapping

from service.coordination.admission import Fault, mission_faults
from service.coordination.coordinator import Coordinator, LoopParameters
from service.coordination.events import MissionCreated
from service.coordination.known_map import grid_map, robot_models
from service.coordination.mission import Mission, rebuilt
from service.coordination.ports import Planners
from service.coordination.strategy import Strategy
from service.messages.mission import CreateMission
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
        max_missions: int,
        max_map_cells: int,
    ) -> None:
        self._store = store
        self._strategies = strategies
        self._planners = planners
        self._parameters = parameters
        self._max_missions = max_missions
        self._max_map_cells = max_map_cells
        self._open: dict[str, Coordinator] = {}

    async def restore(self) -> int:
        """Takes up all missions that are not over; returns their number."""
        for mission_id in await asyncio.to_thread(self._store.open_missions):
            mission = await asyncio.to_thread(rebuilt, self._store.events(mission_id))
            coordinator = self._coordinator(mission)
            self._open[mission_id] = coordinator
            if mission.status != "queued":
                coordinator.replan("the service was started again")
        return len(self._open)

    async def create(self, request: CreateMission) -> Coordinator:
        """A new mission, stored before it is returned.

        Raises:
            MissionRefusedError: with everything that is wrong with it.
            FullError: too many missions are open.
        """
        self._forget_closed()
        if len(self._open) >= self._max_missions:
            raise FullError(f"{len(self._open)} missions are open, which is all that is allowed")
        faults = mission_faults(request, self._strategies, self._max_map_cells)
        if faults:
            raise MissionRefusedError(faults)
        event = MissionCreated(id=uuid.uuid4().hex, request=request)
        await asyncio.shield(asyncio.ensure_future(self._store.append(event.id, 0, [event])))
        coordinator = self._coordinator(Mission.created(event))
        self._open[event.id] = coordinator
        return coordinator

    async def find(self, mission_id: str) -> Coordinator | None:
        """A mission, open or over; None if there never was one."""
        if (coordinator := self._open.get(mission_id)) is not None:
            return coordinator
        events = await asyncio.to_thread(lambda: list(self._store.events(mission_id)))
        return self._coordinator(rebuilt(events)) if events else None

    async def stop(self) -> None:
        """Stops all loops; every mission goes on when the service is started again."""
        for coordinator in self._open.values():
            await coordinator.stop()

    def _forget_closed(self) -> None:
        for mission_id in [key for key, value in self._open.items() if value.mission.is_over]:
            del self._open[mission_id]

    def _coordinator(self, mission: Mission) -> Coordinator:
        request = mission.request
        return Coordinator(
            mission,
            grid=grid_map(request.map, self._max_map_cells),
            models=robot_models(request),
            strategy=self._strategies[request.strategy],
            log=self._store,
            planners=self._planners,
            parameters=self._parameters,
        )
